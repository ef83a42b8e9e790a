"""An atlas of paths: closed curves of many mechanisms, found again by their shape."""
