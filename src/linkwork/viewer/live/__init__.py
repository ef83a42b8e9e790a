"""The live page: a mechanism file edited in a browser, solved here, saved back with comments.

``messages`` is what page and program say to each other, ``workbench`` the file being edited,
``server`` the only part that knows of a network.
"""
