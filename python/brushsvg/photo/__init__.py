"""From a picture to marks in mm: markers, flattening, edges."""

PHOTOS = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".webp")  # extensions of readable pictures
