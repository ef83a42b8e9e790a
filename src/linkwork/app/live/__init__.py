"""The live page: edit a mechanism file in a browser; Linkwork solves it and keeps its comments.

``messages`` translates requests and events, ``workbench`` holds the edited file, ``server`` is the
only module that uses the network.
"""
