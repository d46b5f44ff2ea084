"""What the programs of this package end with."""

OK, FAILED, BAD_CALL, INTERRUPTED = 0, 1, 2, 130
