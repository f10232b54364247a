/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <pico/stdlib.h>

struct spi_inst_t;
typedef struct { volatile uint32_t cr0, cr1, dr; } spi_hw_t;
enum spi_cpol_t { SPI_CPOL_0, SPI_CPOL_1 };
enum spi_cpha_t { SPI_CPHA_0, SPI_CPHA_1 };
enum spi_order_t { SPI_LSB_FIRST, SPI_MSB_FIRST };
extern spi_inst_t* const spi0;

uint spi_init(spi_inst_t* spi, uint baudrate);
void spi_set_format(spi_inst_t* spi, uint data_bits, spi_cpol_t cpol, spi_cpha_t cpha, spi_order_t order);
int spi_write_blocking(spi_inst_t* spi, const uint8_t* src, size_t len);
bool spi_is_busy(const spi_inst_t* spi);
spi_hw_t* spi_get_hw(spi_inst_t* spi);
uint spi_get_dreq(spi_inst_t* spi, bool is_tx);
