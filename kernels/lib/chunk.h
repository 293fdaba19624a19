// A chunked kernel: item g of G works on elements [n g / G, n (g + 1) / G) of n.
#ifndef HR_LIB_CHUNK_H
#define HR_LIB_CHUNK_H

static inline uint chunk_begin(uint n, uint g, uint groups) { return (uint)((ulong)n * g / groups); }

#endif
