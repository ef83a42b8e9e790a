"""Ground layer: errors, statuses, angles, names, immutable containers."""
