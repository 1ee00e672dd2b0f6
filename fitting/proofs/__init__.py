"""Proofs about a fitted form on its whole domain."""
