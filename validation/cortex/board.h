#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* Prints words and a number on the host. */
void say(const char *words, int64_t number);
/* A reading of the counter, and the instructions since one; exact to 40. */
uint32_t ticks(void);
uint32_t instructions_since(uint32_t start);
/* The test. */
void run(void);

#endif
