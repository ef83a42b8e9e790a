"""The documentation site: its generated pages, its directives, its checks."""
