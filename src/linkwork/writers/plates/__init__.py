"""Plates to cut or print: outlines, layers, bill of materials, and files of them."""
