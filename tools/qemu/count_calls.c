// SPDX-License-Identifier: Apache-2.0
// A TCG plugin that counts the instructions of calls: from the entry of one function to that of another, exactly and repeatably.
//   qemu-... -plugin count_calls.so,begin=ADDRESS,end=ADDRESS,out=FILE
// writes a line with the count each time `end` is entered. Debian's QEMU loads plugins but has no header for them: what is used of its interface
// (version 1, documented in QEMU's docs/devel/tcg-plugins) is declared here.
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef uint64_t plugin_id;
struct tb;
struct insn;
int qemu_plugin_version = 1;
void qemu_plugin_register_vcpu_tb_trans_cb(plugin_id id, void (*cb)(plugin_id, struct tb*));
size_t qemu_plugin_tb_n_insns(const struct tb*);
struct insn* qemu_plugin_tb_get_insn(const struct tb*, size_t);
uint64_t qemu_plugin_insn_vaddr(const struct insn*);
void qemu_plugin_register_vcpu_insn_exec_inline(struct insn*, int op, void*, uint64_t);
void qemu_plugin_register_vcpu_insn_exec_cb(struct insn*, void (*cb)(unsigned, void*), int flags, void*);

static uint64_t executed, begun, begin_address, end_address;
static FILE* out;

static void at_begin(unsigned cpu, void* data) {
  (void)cpu; (void)data;
  begun = executed;
}
static void at_end(unsigned cpu, void* data) {
  (void)cpu; (void)data;
  fprintf(out, "%" PRIu64 "\n", executed - begun);
  fflush(out);
}

static void translate(plugin_id id, struct tb* block) {
  (void)id;
  const size_t count = qemu_plugin_tb_n_insns(block);
  for (size_t k = 0; k < count; ++k) {
    struct insn* i = qemu_plugin_tb_get_insn(block, k);
    const uint64_t address = qemu_plugin_insn_vaddr(i);
    if (address == begin_address) qemu_plugin_register_vcpu_insn_exec_cb(i, at_begin, 0, NULL);
    if (address == end_address) qemu_plugin_register_vcpu_insn_exec_cb(i, at_end, 0, NULL);
    qemu_plugin_register_vcpu_insn_exec_inline(i, 0, &executed, 1);
  }
}

int qemu_plugin_install(plugin_id id, const void* info, int argc, char** argv) {
  (void)info;
  for (int k = 0; k < argc; ++k) {
    if (strncmp(argv[k], "begin=", 6) == 0) begin_address = strtoull(argv[k] + 6, NULL, 0);
    else if (strncmp(argv[k], "end=", 4) == 0) end_address = strtoull(argv[k] + 4, NULL, 0);
    else if (strncmp(argv[k], "out=", 4) == 0) out = fopen(argv[k] + 4, "w");
    else return 1;
  }
  if (out == NULL || begin_address == 0 || end_address == 0) return 1;
  qemu_plugin_register_vcpu_tb_trans_cb(id, translate);
  return 0;
}
