"""The equations of a mechanism as formulas of its dimensions, unknowns and inputs."""
