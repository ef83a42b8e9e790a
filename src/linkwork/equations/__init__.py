"""Loop-closure equations: written from a mechanism or read from a person, shown, compiled."""
