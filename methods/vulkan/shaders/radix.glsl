// Keys of one or two words, sorted by one digit at a time.
layout(constant_id = 1) const uint items = 1;  // keys of an invocation
layout(constant_id = 2) const uint digits = 2;

uint digit(uint word, uint shift) { return word >> shift & (digits - 1); }
