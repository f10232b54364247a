/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <pico/stdlib.h>

typedef struct { uint32_t ctrl; } dma_channel_config;
enum dma_channel_transfer_size { DMA_SIZE_8, DMA_SIZE_16, DMA_SIZE_32 };

int dma_claim_unused_channel(bool required);
dma_channel_config dma_channel_get_default_config(uint channel);
void channel_config_set_transfer_data_size(dma_channel_config* c, dma_channel_transfer_size size);
void channel_config_set_dreq(dma_channel_config* c, uint dreq);
void dma_channel_configure(uint channel, const dma_channel_config* config, volatile void* write_addr, const volatile void* read_addr, uint transfer_count, bool trigger);
void dma_channel_wait_for_finish_blocking(uint channel);
