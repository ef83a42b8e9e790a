"""An atlas of paths: closed curves of many mechanisms, searched by shape."""
