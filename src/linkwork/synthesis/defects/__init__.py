"""Whether a design is sound: its branch, circuit, order, driven range and wishes, and why not."""
