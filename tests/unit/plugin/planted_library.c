/* What a plugin may bring along. */
int in_a_library(void);
int in_a_library(void) { return 7; }
