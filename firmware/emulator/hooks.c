/* SPDX-License-Identifier: Apache-2.0
   What the emulator has to look at in every instruction and every access to memory, in C because it
   happens so often. */
#include <stdint.h>

#define RANGES 4
#define FLASH_HALFWORDS 0x3FFFF

typedef struct {
  uint64_t instructions; /* executed so far */
  uint64_t limit;        /* stop before the one with this number */
  uint32_t address;      /* of the newest instruction */
  uint32_t begin[RANGES]; /* memory that a peripheral owns: [begin, end) */
  uint32_t end[RANGES];
  uint32_t may_read[RANGES]; /* the program may read it meanwhile */
  uint32_t trespasses;
  uint32_t trespassed_by; /* address of the first instruction that did */
  uint64_t* addresses;    /* if not null: the last 64 instructions, in a ring */
  const uint8_t* near_it; /* for each halfword of flash memory: it may be in an IT block */
} Meter;

/* Functions of Unicorn, whose library this one is not linked with. */
static int (*stop)(void* uc);
static int (*read_register)(void* uc, int number, void* value);
static int (*write_register)(void* uc, int number, const void* value);

void use(void* uc_emu_stop, void* uc_reg_read, void* uc_reg_write) {
  stop = (int (*)(void*))uc_emu_stop;
  read_register = (int (*)(void*, int, void*))uc_reg_read;
  write_register = (int (*)(void*, int, const void*))uc_reg_write;
}

/* Unicorn 2.1 leaves the state of an IT block behind when a load or store in it is hooked
   (unicorn-engine issue 2309). It has no use for that state within translated code. To read the
   state is slow, so this is done only where the program may have an IT block. */
static void forget_it_block(void* uc) {
  const int xpsr = XPSR;
  const uint32_t bits = 0x0600FC00;
  uint32_t value = 0;
  read_register(uc, xpsr, &value);
  if (!(value & bits)) return;
  value &= ~bits;
  write_register(uc, xpsr, &value);
}

void on_instruction(void* uc, uint64_t address, uint32_t size, void* data) {
  Meter* meter = data;
  (void)size;
  if (meter->instructions >= meter->limit) {
    stop(uc);
    return;
  }
  meter->address = (uint32_t)address;
  if (meter->addresses) meter->addresses[meter->instructions % 64] = address;
  ++meter->instructions;
}

void on_access(void* uc, int type, uint64_t address, int size, int64_t value, void* data) {
  Meter* meter = data;
  const int writes = type == 17; /* UC_MEM_WRITE */
  (void)value;
  if (meter->near_it[meter->address >> 1 & FLASH_HALFWORDS]) forget_it_block(uc);
  for (int i = 0; i < RANGES; ++i) {
    if (address + (uint64_t)size <= meter->begin[i] || address >= meter->end[i]) continue;
    if (!writes && meter->may_read[i]) continue;
    if (meter->trespasses++ == 0) meter->trespassed_by = meter->address;
  }
}
