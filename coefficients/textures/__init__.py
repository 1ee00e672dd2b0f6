"""Texture files of numbers: OpenEXR, 16-bit PNG, DDS and KTX2, as their specifications say.

Every writer takes an array of texels, whose last dimension is the width, and returns the bytes of a
file. `formats` lists the formats with the texels and the dimensions that each can hold.
"""
