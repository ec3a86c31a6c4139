/* One plugin for each way to be wrong: CMakeLists.txt says by definitions what each does. */
#include <stdlib.h>

#include "hal/plugin/plugin_abi.h"

#ifndef MAGIC
#define MAGIC THIMBLE_PLUGIN_MAGIC
#endif
#ifndef VERSION
#define VERSION THIMBLE_PLUGIN_ABI_VERSION
#endif
#ifndef REVISION
#define REVISION THIMBLE_PLUGIN_ABI_REVISION
#endif
#ifndef BYTES
#define BYTES sizeof(struct thimble_plugin)
#endif
#ifndef DRIVER
#define DRIVER &driver
#endif
#ifndef DRIVER_BYTES
#define DRIVER_BYTES sizeof(struct thimble_driver)
#endif
#ifndef DRIVER_NAME
#define DRIVER_NAME "planted"
#endif
#ifndef DECODE
#define DECODE decode
#endif
#ifndef MODELS
#define MODELS models
#endif
#ifndef MODEL_COUNT
#define MODEL_COUNT 1
#endif
#ifndef MODEL_NAME
#define MODEL_NAME "planted"
#endif
#ifndef ADVANCE
#define ADVANCE advance
#endif

#ifndef USB_DRIVER
#define USB_DRIVER 0
#endif
#ifndef USB_BYTES
#define USB_BYTES sizeof(struct thimble_usb_driver)
#endif
#ifndef USB_NAME
#define USB_NAME "planted-usb"
#endif
#ifndef USB_PIPES
#define USB_PIPES 2
#endif
#ifndef USB_READ
#define USB_READ usb_read
#endif

static int32_t match(const struct thimble_hid_info* info,
                     const struct thimble_driver_settings* settings,
                     struct thimble_reason* reason) {
  (void)info, (void)settings, (void)reason;
  return THIMBLE_NOT_MINE;
}
static int32_t open_arm(const struct thimble_hid_info* info,
                        const struct thimble_driver_settings* settings,
                        struct thimble_capabilities* capabilities, void** device,
                        struct thimble_reason* reason) {
  (void)info, (void)settings, (void)capabilities, (void)device, (void)reason;
  return THIMBLE_REFUSED;
}
static void leave(void* device) { (void)device; }
static int32_t decode(void* device, const struct thimble_hid_report* report,
                      struct thimble_sample* sample) {
  (void)device, (void)report, (void)sample;
  return THIMBLE_NO_DATA;
}
static int32_t encode(void* device, const struct thimble_wrench* wrench, uint8_t* bytes) {
  (void)device, (void)wrench, (void)bytes;
  return THIMBLE_PROTOCOL_ERROR;
}

static int32_t create(const struct thimble_model_settings* settings,
                      struct thimble_model_facts* facts, void** device,
                      struct thimble_reason* reason) {
  (void)settings, (void)facts, (void)device, (void)reason;
  return THIMBLE_REFUSED;
}
static void advance(void* device, int64_t t_ns) { (void)device, (void)t_ns; }
static void out_report(void* device, const uint8_t* bytes, uint32_t size) {
  (void)device, (void)bytes, (void)size;
}
static uint32_t in_report(void* device, uint8_t* bytes) {
  (void)device, (void)bytes;
  return 0;
}
static void hold_tip(void* device, const struct thimble_tip_load* load) {
  (void)device, (void)load;
}
static void push_tip(void* device, const double* force_newton) { (void)device, (void)force_newton; }
static void turn_stylus(void* device, const double* angle_rad) { (void)device, (void)angle_rad; }
static int32_t move_tip_to(void* device, const double* tip_m) {
  (void)device, (void)tip_m;
  return THIMBLE_REFUSED;
}
static void press(void* device, int32_t pressed) { (void)device, (void)pressed; }
static void read_truth(void* device, struct thimble_arm_truth* truth) { (void)device, (void)truth; }

static int32_t usb_match(const struct thimble_usb_info* info,
                         const struct thimble_usb_settings* settings,
                         struct thimble_reason* reason) {
  (void)info, (void)settings, (void)reason;
  return THIMBLE_NOT_MINE;
}
static int32_t usb_open(const struct thimble_usb_info* info,
                        const struct thimble_usb_settings* settings,
                        const struct thimble_usb_bus* bus,
                        struct thimble_capabilities* capabilities, struct thimble_usb_zero* zero,
                        void** device, struct thimble_reason* reason) {
  (void)info, (void)settings, (void)bus, (void)capabilities, (void)zero, (void)device, (void)reason;
  return THIMBLE_REFUSED;
}
static int32_t usb_read(void* device, struct thimble_usb_sample* sample) {
  (void)device, (void)sample;
  return THIMBLE_NO_DATA;
}
static int32_t usb_write(void* device, const struct thimble_wrench* wrench) {
  (void)device, (void)wrench;
  return THIMBLE_PROTOCOL_ERROR;
}
static void usb_instruction(void* device, struct thimble_reason* instruction) {
  (void)device, (void)instruction;
}
const struct thimble_usb_driver usb_driver = {
    USB_BYTES, 0,         USB_NAME,  {0, USB_PIPES, {{0x81, 1}, {0x02, 0}}},
    {0},       usb_match, usb_open,  leave,
    leave,     USB_READ,  usb_write, usb_instruction};
const void* unused_as_well(void) { return (const void*)usb_read; }

static const struct thimble_model* const models[2];
static const struct thimble_driver driver = {DRIVER_BYTES, 0,     DRIVER_NAME, match, open_arm,
                                             leave,        leave, DECODE,      encode};

static const struct thimble_model model = {sizeof(struct thimble_model),
                                           0,
                                           MODEL_NAME,
                                           "planted",
                                           create,
                                           leave,
                                           ADVANCE,
                                           out_report,
                                           in_report,
                                           leave,
                                           hold_tip,
                                           push_tip,
                                           move_tip_to,
                                           press,
                                           press,
                                           turn_stylus,
                                           read_truth};
static const struct thimble_model* const models[] = {&model, &model};

/* For those that point elsewhere. */
#define ELSEWHERE ((const void*)&environ)
#define NOWHERE ((const void*)8)
extern char** environ;
extern int is_nowhere_defined(void);

#if defined(NEEDS_LIBRARY)
extern int in_a_library(void);
__attribute__((visibility("default"))) int call_it(void) { return in_a_library(); }
#endif

#if defined(NO_SYMBOL)

const void* unused(void) { return &models; }
const void* unused_too(void) { return &driver; }
#elif defined(UNDEFINED)
__attribute__((visibility("default"))) int call(void) { return is_nowhere_defined(); }
#elif defined(SHORT)
/* Another object of the name, with the head of a plugin and nothing else. */
__asm__(
    ".globl thimble_plugin_v0\n.type thimble_plugin_v0, @object\n.size thimble_plugin_v0, 12\n"
    ".section .data\n.balign 8\nthimble_plugin_v0: .long 0x504d4854, 0, 1\n.text\n");
const void* unused(void) { return &models; }
const void* unused_too(void) { return &driver; }
#elif defined(BETWEEN)
/* Behind the code, in what is left of its page. */
__asm__(
    ".globl thimble_plugin_v0\n.type thimble_plugin_v0, @object\n.size thimble_plugin_v0, 40\n"
    ".text\n.balign 8\nhere: nop\n.set thimble_plugin_v0, here + 0xa00\n");
const void* unused(void) { return &models; }
const void* unused_too(void) { return &driver; }
#elif defined(FUNCTION)
__asm__(
    ".globl thimble_plugin_v0\n.type thimble_plugin_v0, @function\n.text\n.balign 16\n"
    "thimble_plugin_v0: ret\n.size thimble_plugin_v0, 1\n");
const void* unused(void) { return &models; }
const void* unused_too(void) { return &driver; }
#else
THIMBLE_PLUGIN = {MAGIC, VERSION, REVISION, BYTES, DRIVER, MODELS, MODEL_COUNT, 0, USB_DRIVER};
const void* unused(void) { return &driver; }
const void* unused_too(void) { return &models; }
#endif
