/* What a driver built outside this tree and thimbled agree on: plain C99, nothing else included.
 * lint: long-file it is all that a plugin is built against, and one file is what it gets
 *
 * A plugin is a shared object that exports one constant, THIMBLE_PLUGIN, and hides the rest. The
 * host compares its numbers before it calls anything in it. docs/plugins.md tells how to write one.
 *
 * Version 0 may change with every release. Each change counts up the revision. The host takes its
 * own and those that differ from it by what was added at the end of a structure only: 2, whose
 * capabilities end before `full_rate_hz`, and 1, whose struct thimble_plugin also ends before
 * `usb_driver`. From version 1 on structures grow at their end only:
 * `struct_bytes` says how much of one the writer knows, what is missing reads as zero, and the
 * symbol's name changes with the version, so that one object can serve two.
 *
 * Bytes of a HID bus are handed in and out: a plugin has no handle on the bus, so it cannot wait
 * for it, and can send nothing but what encode() makes of a force that the limiter has let through.
 * A driver of a bare USB device has to talk to it before there is any force (a boot, an upload), so
 * it gets the pipes that it claims, and nothing on them ever waits; what it does with a force is
 * its maker's word.
 *
 * Thread: the functions of one device, and those of one simulated device, are called by one thread
 *   at a time; those of different devices may run at once, so a plugin has no state but theirs.
 *   "Non-RT" is any thread that is not real-time; an arm is opened and closed in one of its own.
 * Real time: where it says RT, the servo thread waits: no allocation, lock, system call, log or
 * unbounded loop, and microseconds rather than milliseconds. Nothing here reads a clock. Errors:
 * enum thimble_status; a reason is a sentence for a person. No exception may leave a function: it
 * would end the process, as a crash does. The host does not contain a plugin; it refuses what it
 * can see, and checks every number that comes back. Ownership: all that is passed belongs to the
 * caller and is valid during the call, unless said. The plugin's own structures are constant, lie
 * in its object, and last as long as the process: it is never unloaded. Text: UTF-8, ended by a
 * zero byte within its array. Units: SI, as the names say. Base frame of an arm: x to the right, y
 * up, z towards the user, its origin in the middle of the workspace. Times are nanoseconds on the
 * clock of the bus.
 */
#ifndef THIMBLE_PLUGIN_ABI_H
#define THIMBLE_PLUGIN_ABI_H

#include <stdint.h>

/* NOLINTBEGIN(readability-identifier-naming): names as C has them. */
#ifdef __cplusplus
extern "C" {
#endif

#define THIMBLE_PLUGIN_MAGIC UINT32_C(0x504d4854) /* "THMP" in memory */
#define THIMBLE_PLUGIN_ABI_VERSION UINT32_C(0)
#define THIMBLE_PLUGIN_ABI_REVISION UINT32_C(3)

#define THIMBLE_NAME_BYTES 32    /* names are 1 to 31 of a-z, 0-9 and - */
#define THIMBLE_TEXT_BYTES 192   /* one sentence */
#define THIMBLE_STRING_BYTES 128 /* of a device's descriptor; longer ones are cut */
#define THIMBLE_REPORT_BYTES 64  /* full-speed interrupt packet, USB 2.0 */
#define THIMBLE_PATH_BYTES 4096
#define THIMBLE_PACKET_BYTES 512 /* bulk packet at high speed, USB 2.0 */
#define THIMBLE_CONTROL_BYTES 64 /* of a request's data stage */
#define THIMBLE_USB_ENDPOINTS 30
#define THIMBLE_USB_PIPES 4
#define THIMBLE_JOINTS 6
#define THIMBLE_MOTORS 3

enum thimble_status {
  THIMBLE_OK = 0,
  THIMBLE_NO_DATA = 1,        /* decode(): a sound report without a new sample */
  THIMBLE_PROTOCOL_ERROR = 2, /* decode(), encode(): counted; no sample, nothing sent */
  THIMBLE_NOT_MINE = 3,       /* match(): ask the next driver */
  THIMBLE_REFUSED = 4,        /* match(), open(), create(), move_tip_to(): see the reason */
  /* Of USB only. */
  THIMBLE_BACKLOGGED = 5,  /* the last packet or request is still under way; this one waits */
  THIMBLE_DISCONNECTED = 6 /* for ever: it was unplugged */
};

enum thimble_calibration {
  THIMBLE_CALIBRATION_UNKNOWN = 0,
  THIMBLE_CALIBRATION_NEEDS_PERSON = 1, /* who must do what calibration_instruction says */
  THIMBLE_CALIBRATION_DONE = 2          /* the tip is known; without it no force is asked for */
};

struct thimble_reason {
  char text[THIMBLE_TEXT_BYTES];
};

/* What can be known of a HID device without touching it. */
struct thimble_hid_info {
  uint32_t struct_bytes;
  uint16_t vendor_id;
  uint16_t product_id;
  uint32_t input_report_bytes;        /* without a report id: devices here use none */
  uint32_t output_report_bytes;       /* both 1 to THIMBLE_REPORT_BYTES */
  char address[THIMBLE_STRING_BYTES]; /* "hid:SERIAL", "sim:MODEL" */
  char manufacturer[THIMBLE_STRING_BYTES];
  char product[THIMBLE_STRING_BYTES];
  char serial_number[THIMBLE_STRING_BYTES]; /* empty when it has none */
};

/* What the configuration says of the arm. */
struct thimble_driver_settings {
  uint32_t struct_bytes;
  uint32_t reserved;
  double amplifier_max_a;           /* full scale of the amplifiers; 0: not said */
  char model[THIMBLE_STRING_BYTES]; /* empty: not said */
};

/* Constant while the device is open. The limiter works with these limits, and the host refuses
 * what no arm has: each range is given, and no number may be infinite or NaN. An arm whose motors
 * are told no amperes has shares of its largest command in their place, the same everywhere: 1 is
 * all that a motor can be told. */
struct thimble_capabilities {
  uint32_t struct_bytes;
  uint32_t joint_count;           /* 3, or 6 with a gimbal whose angles are measured */
  char model[THIMBLE_NAME_BYTES]; /* a name */
  char calibration_instruction[THIMBLE_TEXT_BYTES]; /* what a person must do, one sentence */
  double peak_force_newton;                         /* above 0 up to 100 */
  double continuous_force_newton;                   /* above 0 up to the peak */
  double max_stiffness_newton_per_m;                /* at 1 kHz; above 0 up to 20000 */
  double workspace_radius_m;                        /* above 0 up to 2 */
  double peak_current_a[THIMBLE_MOTORS];            /* above 0 up to 100: the limiter's clamp */
  double continuous_current_a[THIMBLE_MOTORS];      /* above 0 up to the peak: its model of heat */
  int64_t sample_period_ns;                         /* of the reports; 100 us to 10 ms */
  /* Motors off after so long without a report; up to 10 s. 0, none: only a simulated arm. */
  int64_t device_watchdog_ns;
  /* Ticks of the servo a second from which on no sample is left out: 500 to 8000; 0: 1000. At it
   * the arm is driven where a person says no rate. */
  double full_rate_hz;
  /* What a newton asks of each motor at most anywhere in the workspace, in the unit of the
   * currents: no motor is told more than that times the force's limit. 1e-6 up to 1e4; 0: its
   * peak alone. */
  double most_current_a_per_newton[THIMBLE_MOTORS];
};

/* One input report. */
struct thimble_hid_report {
  uint32_t struct_bytes;
  uint32_t size;         /* of `bytes` */
  int64_t arrived_at_ns; /* never backwards */
  uint64_t sequence;     /* +1 for every report that arrived, handed over or not */
  uint8_t bytes[THIMBLE_REPORT_BYTES];
};

/* One measured state. When it was measured is the host's to say: when its report arrived. */
struct thimble_sample {
  uint32_t struct_bytes;
  int32_t calibration; /* enum thimble_calibration */
  uint32_t buttons;    /* bit 0: stylus button */
  uint32_t reserved;   /* 0 */
  /* 0 to 2 carry the tip: up to 1e6 either way. 3 to 5 are the gimbal's axes, -pi to pi, 0 as the
   * stylus was held during calibration. Those beyond joint_count, and all before calibration, count
   * as 0. */
  double joint_position_rad[THIMBLE_JOINTS];
  double tip_m[3]; /* base frame; up to 10 either way */
  /* Currents for a force at the tip in this pose: I = M * F, a row for each motor. Up to 1e4; not
   * all zero once calibrated, for then no current would be limited. */
  double motor_current_a_per_newton[THIMBLE_MOTORS][3];
};

/* A force at the tip, base frame, that the limiter has let through. */
struct thimble_wrench {
  uint32_t struct_bytes;
  uint32_t reserved;
  double force_newton[3];
};

/* Finds and opens devices of one family. Every function must be there. */
struct thimble_driver {
  uint32_t struct_bytes;
  uint32_t reserved;
  char name[THIMBLE_NAME_BYTES]; /* a name that no other driver has */

  /* Whether the driver drives that device with those settings: OK, NOT_MINE, or REFUSED and why.
   * Passive. Thread: non-RT, any number at once. */
  int32_t (*match)(const struct thimble_hid_info* info,
                   const struct thimble_driver_settings* settings, struct thimble_reason* reason);
  /* After a match, for a device that the host has opened: makes what the other functions get as
   * `device` (not null) and fills in the capabilities. OK, or REFUSED and why.
   * Thread: non-RT. */
  int32_t (*open)(const struct thimble_hid_info* info,
                  const struct thimble_driver_settings* settings,
                  struct thimble_capabilities* capabilities, void** device,
                  struct thimble_reason* reason);
  /* Ends the life of `device`. The host has sent zero before, but not where encode() failed or the
   * bus was gone, nor where it refused the capabilities, and sent nothing at all.
   * Thread: non-RT. */
  void (*close)(void* device);

  /* The reference is worth nothing any more: the arm must be calibrated again. DONE is believed
   * again after a sample that does not say it. RT. Thread: non-RT before the first report,
   * then the servo's. */
  void (*forget_calibration)(void* device);
  /* Makes a sample of the newest report; older ones may have been left out, which its number shows.
   * The bytes may be anything. The sample comes zeroed. OK, NO_DATA or PROTOCOL_ERROR. RT. */
  int32_t (*decode)(void* device, const struct thimble_hid_report* report,
                    struct thimble_sample* sample);
  /* Makes the output report, of just output_report_bytes, that has the arm exert `wrench` until the
   * next one or its own watchdog. Called once a tick, also with zero, also before the first
   * report; not while the arm is unplugged, nor any more once a stop has been answered by zero for
   * a while: then the arm's watchdog ends it. `bytes` comes zeroed. OK, or PROTOCOL_ERROR: nothing
   * is sent. RT.
   * The first call after open() is for no force, and is not sent but kept: it is what the guard of
   * this arm writes when the daemon stops, so it must take the force away at any time. */
  int32_t (*encode)(void* device, const struct thimble_wrench* wrench,
                    uint8_t bytes[THIMBLE_REPORT_BYTES]);
};

/* One endpoint, as the device's descriptors tell of it. */
struct thimble_usb_endpoint {
  uint8_t interface_number;
  uint8_t address; /* 0x81: endpoint 1 to the host; 0x02: endpoint 2 from it */
  uint8_t kind;    /* bits 0 and 1 of bmAttributes: 2 bulk, 3 interrupt */
  uint8_t reserved;
  uint16_t max_packet_bytes;
  uint16_t reserved_too;
};

/* What can be known of a USB device without touching it. */
struct thimble_usb_info {
  uint32_t struct_bytes;
  uint16_t vendor_id;
  uint16_t product_id;
  uint32_t endpoint_count;
  uint32_t reserved;
  struct thimble_usb_endpoint endpoints[THIMBLE_USB_ENDPOINTS];
  char address[THIMBLE_STRING_BYTES]; /* "usb:PORT", "sim:MODEL" */
  char manufacturer[THIMBLE_STRING_BYTES];
  char product[THIMBLE_STRING_BYTES];
  char serial_number[THIMBLE_STRING_BYTES]; /* empty when it has none */
};

/* What the configuration says of the arm. */
struct thimble_usb_settings {
  uint32_t struct_bytes;
  uint32_t reserved;
  double amplifier_max_a;            /* 0: not said */
  double newton_per_count;           /* 0: not said */
  char model[THIMBLE_STRING_BYTES];  /* empty: not said; so the next two */
  char firmware[THIMBLE_PATH_BYTES]; /* a file */
  char sha256[THIMBLE_STRING_BYTES]; /* of that file, hexadecimal */
};

struct thimble_usb_pipe {
  uint8_t endpoint;
  uint8_t is_queued; /* input: 1, packets wait in order; 0, only the newest is kept */
};

/* The interface and the endpoints that a driver uses. */
struct thimble_usb_claim {
  uint8_t interface_number;
  uint8_t pipe_count; /* 1 to THIMBLE_USB_PIPES */
  struct thimble_usb_pipe pipes[THIMBLE_USB_PIPES];
};

struct thimble_usb_packet {
  uint32_t struct_bytes;
  uint32_t size;         /* of `bytes`; 0: an empty packet */
  int64_t arrived_at_ns; /* never backwards */
  uint64_t sequence;     /* +1 for every packet of its endpoint that arrived, read or not */
  uint8_t bytes[THIMBLE_PACKET_BYTES];
};

/* A request to endpoint 0; fields as in USB 2.0, 9.3. */
struct thimble_usb_request {
  uint32_t struct_bytes;
  uint8_t request_type; /* the device's class or vendor's only */
  uint8_t request;
  uint16_t value;
  uint16_t index;
  uint16_t length; /* of the data stage */
  uint8_t data[THIMBLE_CONTROL_BYTES];
};

struct thimble_usb_reply {
  uint32_t struct_bytes;
  int32_t outcome; /* 0 done, 1 stalled, 2 babbled, 3 failed */
  uint32_t size;   /* of `data` */
  uint8_t data[THIMBLE_CONTROL_BYTES];
};

/* The claimed pipes of one device. The host's; valid from open() to the end of close(). Every call
 * is RT and never waits. Thread: that of the device's functions. */
struct thimble_usb_bus {
  uint32_t struct_bytes;
  uint32_t reserved;
  void* context; /* first argument of all */
  /* OK, NO_DATA, PROTOCOL_ERROR (no such pipe) or DISCONNECTED. */
  int32_t (*read)(void* context, uint8_t endpoint, struct thimble_usb_packet* packet);
  /* One packet: OK, BACKLOGGED, PROTOCOL_ERROR or DISCONNECTED. */
  int32_t (*submit)(void* context, uint8_t endpoint, const uint8_t* bytes, uint32_t size);
  /* One at a time: OK, BACKLOGGED, PROTOCOL_ERROR or DISCONNECTED. */
  int32_t (*start_control)(void* context, const struct thimble_usb_request* request);
  /* OK once for each that ended, NO_DATA or DISCONNECTED. */
  int32_t (*read_control)(void* context, struct thimble_usb_reply* reply);
};

/* One measured state, and when it was measured. One that is not new, or younger than every packet
 * that was read, is none. */
struct thimble_usb_sample {
  struct thimble_sample state;
  int64_t sampled_at_ns; /* when its packet arrived */
  uint64_t sequence;     /* +1 for every sample of the device, handed over or not */
};

/* The packet that takes the force away at any time, for whoever writes it. */
struct thimble_usb_zero {
  uint32_t struct_bytes;
  uint32_t size; /* of `bytes`: 1 to THIMBLE_REPORT_BYTES */
  uint8_t endpoint;
  uint8_t reserved[7];
  uint8_t bytes[THIMBLE_REPORT_BYTES];
};

/* Finds and opens bare USB devices of one family. Every function must be there. Since revision 2.
 */
struct thimble_usb_driver {
  uint32_t struct_bytes;
  uint32_t reserved;
  char name[THIMBLE_NAME_BYTES]; /* a name that no other driver has */
  struct thimble_usb_claim claim;
  uint8_t reserved_too[6];

  /* As those of thimble_driver. The capabilities' instruction counts for nothing here, and a device
   * that takes the zero needs no watchdog. `bus` sends nothing before the first write(). */
  int32_t (*match)(const struct thimble_usb_info* info, const struct thimble_usb_settings* settings,
                   struct thimble_reason* reason);
  int32_t (*open)(const struct thimble_usb_info* info, const struct thimble_usb_settings* settings,
                  const struct thimble_usb_bus* bus, struct thimble_capabilities* capabilities,
                  struct thimble_usb_zero* zero, void** device, struct thimble_reason* reason);
  /* May send one last zero; the host sends that of open() before and after. Thread: non-RT. */
  void (*close)(void* device);
  void (*forget_calibration)(void* device);
  /* Takes what came. Comes zeroed. OK with a sample; NO_DATA, PROTOCOL_ERROR; DISCONNECTED, for
   * good, also of an arm that is there and given up: it is closed and opened anew, once it has
   * taken the zero where it may hold a force. RT. */
  int32_t (*read)(void* device, struct thimble_usb_sample* sample);
  /* Once a tick, also with zero, also before the arm is ready: then its next step. As the bus
   * answered: OK, BACKLOGGED, PROTOCOL_ERROR or DISCONNECTED. RT. */
  int32_t (*write)(void* device, const struct thimble_wrench* wrench);
  /* What a person must do now; empty: nothing. Thread: non-RT, while others run. */
  void (*read_instruction)(void* device, struct thimble_reason* instruction);
};

/* Who holds the tip of a simulated arm. Belongs to the host; valid until hold_tip(NULL) or
 * destroy(). Call it only within advance(), once a step of the plant. RT. */
struct thimble_tip_load {
  uint32_t struct_bytes;
  uint32_t reserved;
  void* context; /* first argument of both */
  /* Force of the hand on the tip at `t_ns`, which may not go backwards nor beyond what advance()
   * was told; dt_ns above 0 up to 10 ms. Zero for anything else. */
  void (*force_on_tip)(void* context, int64_t t_ns, int64_t dt_ns, const double tip_m[3],
                       const double velocity_m_per_s[3], double force_newton[3]);
  int32_t (*is_button_pressed)(void* context, int64_t t_ns); /* stylus button: 0 or 1 */
};

/* The truth inside a simulated arm, for tests. */
struct thimble_arm_truth {
  uint32_t struct_bytes;
  int32_t is_amplifier_on; /* 0 or 1 */
  double tip_m[3];
  double tip_velocity_m_per_s[3];
  double motor_force_newton[3]; /* that the motors exert at the tip now */
  double motor_current_a[THIMBLE_MOTORS];
  double gimbal_rad[3];       /* 0 at home with the stylus straight; 0 without a gimbal */
  double mechanical_energy_j; /* kinetic and potential */
};

struct thimble_model_settings {
  uint32_t struct_bytes;
  uint32_t reserved;
  double amplifier_max_a; /* full scale that the firmware was built with; 0: not said */
  uint64_t seed;          /* all that may differ by chance comes from it */
};

/* What a simulated device says of itself. */
struct thimble_model_facts {
  uint32_t struct_bytes;
  uint32_t reserved;
  int64_t frame_period_ns; /* of the bus: 125 us to 10 ms */
  double home_m[3];        /* where the tip must be held while the calibration button is pressed */
  struct thimble_hid_info info; /* its address is the host's to give */
};

/* A simulated arm: mechanics, motors and firmware behind the same reports. Every function must be
 * there. Same calls, same answers: no chance but the seed's, no time but advance()'s.
 * Thread: create() and destroy() non-RT; the rest that of the bus, RT. */
struct thimble_model {
  uint32_t struct_bytes;
  uint32_t reserved;
  char name[THIMBLE_NAME_BYTES];        /* a name that no other model has: "sim:NAME" */
  char description[THIMBLE_TEXT_BYTES]; /* for lists */

  /* OK, or REFUSED and why. `device` (not null) is what the others get. */
  int32_t (*create)(const struct thimble_model_settings* settings,
                    struct thimble_model_facts* facts, void** device,
                    struct thimble_reason* reason);
  void (*destroy)(void* device);

  /* The bus's face. Once a frame: advance(), then out_report() where the host had sent one before
   * the frame began, then in_report(). */
  void (*advance)(void* device, int64_t t_ns); /* never backwards; the first call sets the clock */
  void (*out_report)(void* device, const uint8_t* bytes, uint32_t size);
  uint32_t (*in_report)(void* device, uint8_t bytes[THIMBLE_REPORT_BYTES]); /* its size; 0: none */
  /* Power cut and restored, as when unplugged: the host's bus does the unplugging itself. */
  void (*power_cycle)(void* device);

  /* The backend's face, in physical verbs. */
  void (*hold_tip)(void* device, const struct thimble_tip_load* load); /* NULL: nobody holds it */
  void (*push_tip)(void* device, const double force_newton[3]);        /* until the next push */
  int32_t (*move_tip_to)(void* device, const double tip_m[3]); /* at rest; REFUSED: out of reach */
  void (*press_calibration_button)(void* device, int32_t pressed);
  void (*press_stylus_button)(void* device, int32_t pressed);
  /* How a person holds the stylus: yaw, pitch, roll. Nothing where there is no gimbal. */
  void (*turn_stylus)(void* device, const double angle_rad[3]);
  void (*read_truth)(void* device, struct thimble_arm_truth* truth); /* comes zeroed */
};

struct thimble_plugin {
  uint32_t magic;        /* THIMBLE_PLUGIN_MAGIC */
  uint32_t abi_version;  /* THIMBLE_PLUGIN_ABI_VERSION */
  uint32_t abi_revision; /* THIMBLE_PLUGIN_ABI_REVISION */
  uint32_t struct_bytes;
  const struct thimble_driver* driver;       /* NULL: none */
  const struct thimble_model* const* models; /* NULL: none */
  uint32_t model_count;                      /* up to 16 */
  uint32_t reserved;
  const struct thimble_usb_driver* usb_driver; /* NULL: none. Since revision 2 */
};

/* What a plugin exports: THIMBLE_PLUGIN = {THIMBLE_PLUGIN_MAGIC, ...}; at file scope. */
#define THIMBLE_PLUGIN_SYMBOL "thimble_plugin_v0"
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
extern const struct thimble_plugin thimble_plugin_v0;
#define THIMBLE_PLUGIN const struct thimble_plugin thimble_plugin_v0

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */

#endif
