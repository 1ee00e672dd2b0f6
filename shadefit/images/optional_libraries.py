"""Libraries that few users need, which are imported only where they are used."""

import importlib
from types import ModuleType

# A library, and what pip installs it
_INSTALLED_BY = {
    "OpenEXR": "'shadefit[maps]'",
    "etcpak": "'shadefit[maps]'",
    "quicktex": "'shadefit[maps]'",
    "skimage": "scikit-image",
    "texture2ddecoder": "'shadefit[maps]'",
}
# A module, and what it is for.
_LIBRARIES = {
    "OpenEXR": "reading EXR files",
    "etcpak": "BC7 compression",
    "quicktex": "BC1 and BC5 compression",
    "quicktex.s3tc.bc1": "BC1 compression",
    "quicktex.s3tc.bc5": "BC5 compression",
    "skimage.data": "drawing photographs",
    "texture2ddecoder": "decoding of compressed blocks",
}


def optional_library(module: str) -> ModuleType:
    """Return one of these modules. Raises ValueError that says what to install."""
    purpose = _LIBRARIES[module]
    try:
        return importlib.import_module(module)
    except ImportError:
        library = module.partition(".")[0]
        raise ValueError(
            f"{purpose} needs the library {library}: "
            f"install it by pip install {_INSTALLED_BY[library]}"
        ) from None
