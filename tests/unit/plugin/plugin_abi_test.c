/* Compiled as C99 and as C++11, never run: the header needs nothing but itself. */
#include "hal/plugin/plugin_abi.h"

#define SIZE_IS(type, bytes) \
  typedef char type##_has_grown[sizeof(struct type) == (bytes) && sizeof(void*) == 8 ? 1 : -1]

/* Whoever changes one of these counts up THIMBLE_PLUGIN_ABI_REVISION. */
typedef char revision_of_these_sizes[THIMBLE_PLUGIN_ABI_REVISION == 3 ? 1 : -1];
SIZE_IS(thimble_reason, 192);
SIZE_IS(thimble_hid_info, 528);
SIZE_IS(thimble_driver_settings, 144);
SIZE_IS(thimble_capabilities, 360);
SIZE_IS(thimble_hid_report, 88);
SIZE_IS(thimble_sample, 160);
SIZE_IS(thimble_wrench, 32);
SIZE_IS(thimble_driver, 88);
SIZE_IS(thimble_tip_load, 32);
SIZE_IS(thimble_arm_truth, 136);
SIZE_IS(thimble_model_settings, 24);
SIZE_IS(thimble_model_facts, 568);
SIZE_IS(thimble_model, 336);
SIZE_IS(thimble_usb_endpoint, 8);
SIZE_IS(thimble_usb_info, 768);
SIZE_IS(thimble_usb_settings, 4376);
SIZE_IS(thimble_usb_claim, 10);
SIZE_IS(thimble_usb_packet, 536);
SIZE_IS(thimble_usb_request, 76);
SIZE_IS(thimble_usb_reply, 76);
SIZE_IS(thimble_usb_bus, 48);
SIZE_IS(thimble_usb_sample, 176);
SIZE_IS(thimble_usb_zero, 80);
SIZE_IS(thimble_usb_driver, 112);
SIZE_IS(thimble_plugin, 48);

THIMBLE_PLUGIN = {THIMBLE_PLUGIN_MAGIC,
                  THIMBLE_PLUGIN_ABI_VERSION,
                  THIMBLE_PLUGIN_ABI_REVISION,
                  sizeof(struct thimble_plugin),
                  0,
                  0,
                  0,
                  0,
                  0};
