"""All six-bars of Watt's second kind whose output turns with the input as nine pairs of angles."""
