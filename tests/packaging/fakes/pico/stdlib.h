/* SPDX-License-Identifier: Apache-2.0
 * As much of the Pico SDK as docs/examples/pico/ uses, declared as in its src/rp2_common/hardware_{gpio,spi,dma}/include and
 * src/common/pico_time/include. https://www.raspberrypi.com/documentation/pico-sdk/ */
#pragma once
#include <stddef.h>
#include <stdint.h>

typedef unsigned int uint;
enum gpio_function { GPIO_FUNC_SPI = 1 };
enum { GPIO_OUT = 1 };

void gpio_init(uint gpio);
void gpio_set_dir(uint gpio, bool out);
void gpio_put(uint gpio, bool value);
void gpio_set_function(uint gpio, gpio_function fn);
void sleep_ms(uint32_t ms);
void tight_loop_contents(void);
