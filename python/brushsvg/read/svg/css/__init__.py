"""Style sheets: the cascade, selectors and values of CSS."""
