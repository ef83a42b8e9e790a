"""Links and joints read off loop equations, as a textbook reads them off the page."""
