"""What osgode costs, against the same work in plain C and against the aims of its design."""
