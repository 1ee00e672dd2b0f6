"""Exported code of maps of anisotropic roughness: the decoders, and the proofs about them."""

from quantities.maps.decoders import DECODERS as DECODERS
