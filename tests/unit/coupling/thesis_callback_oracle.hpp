#pragma once

// State of a plain retelling of the callback printed in thesis appendix A, as globals, the
// way a C program of 1999 holds them. Only for comparison; shares nothing with the product.
namespace thesis_callback_oracle {

extern float constraint[3];
extern float adjpos[3];
extern unsigned char constdir;
extern float offset[3];

void restart();
void callback(const float position[3], const float velocity[3], float force[3]);

}  // namespace thesis_callback_oracle
