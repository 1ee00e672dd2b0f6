"""Maps of anisotropic roughness: whole images, their mip levels, files and errors."""
