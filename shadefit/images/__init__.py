"""Images: files of texels, and block compression."""
