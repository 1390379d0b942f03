"""From cracks to cause: which motions of supports, or changes of loads, explain what was measured on a structure."""
