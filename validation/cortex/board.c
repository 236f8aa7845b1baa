/* A board with a Cortex-M4F, as far as the test needs it: its start, its counter of instructions, its way to the host. */
#include "board.h"

extern uint32_t stack_top, data_load, data_start, data_end, bss_start, bss_end;

static void reset(void);

__attribute__((section(".vectors"), used)) static const void *const vectors[2] = {&stack_top, (const void *)reset};

#define CPACR (*(volatile uint32_t *)0xE000ED88u)
#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014u)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018u)

static int32_t to_host(int32_t operation, const void *argument)
{
    register int32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void say(const char *words, int64_t number)
{
    char digits[24];
    int k = 23, negative = number < 0;
    uint64_t rest = negative ? (uint64_t)-number : (uint64_t)number;
    digits[k] = 0;
    do {
        digits[--k] = (char)('0' + (int)(rest % 10u));
        rest /= 10u;
    } while (rest != 0);
    if (negative) {
        digits[--k] = '-';
    }
    to_host(4, words);
    to_host(4, " ");
    to_host(4, digits + k);
    to_host(4, "\n");
}

/* The emulator executes 40 instructions in a tick; the counter runs down in 24 bits. */
uint32_t ticks(void)
{
    return SYSTICK_VALUE;
}

uint32_t instructions_since(uint32_t start)
{
    return 40u * ((start - SYSTICK_VALUE) & 0xFFFFFFu);
}

/* The compiler calls these. */
void *memcpy(void *to, const void *from, size_t count)
{
    size_t k;
    for (k = 0; k < count; k++) {
        ((volatile unsigned char *)to)[k] = ((const unsigned char *)from)[k];
    }
    return to;
}

void *memset(void *to, int value, size_t count)
{
    size_t k;
    for (k = 0; k < count; k++) {
        ((volatile unsigned char *)to)[k] = (unsigned char)value;
    }
    return to;
}

static void reset(void)
{
    static const struct {
        uint32_t reason, status;
    } done = {0x20026u, 0u};
    uint32_t *from = &data_load, *to;
    CPACR |= 0xFu << 20; /* the unit of floating point */
    __asm__ volatile("dsb\n isb");
    for (to = &data_start; to < &data_end; to++) {
        *to = *from++;
    }
    for (to = &bss_start; to < &bss_end; to++) {
        *to = 0;
    }
    SYSTICK_RELOAD = 0xFFFFFFu;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 5; /* on, by the processor's clock */
    (void)ticks();
    run();
    to_host(0x20, &done);
    for (;;) {
    }
}
