// A column in a sparse row.
#ifndef HR_RADIOSITY_ROW_SEARCH_H
#define HR_RADIOSITY_ROW_SEARCH_H

// The first entry of [begin, end) whose column is not below `column`.
static inline uint first_entry(global const uint* restrict columns, uint begin, uint end, uint column) {
  while (begin < end) {
    const uint middle = begin + (end - begin) / 2;
    if (columns[middle] < column) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin;
}

#endif
