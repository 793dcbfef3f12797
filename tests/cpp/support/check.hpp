// SPDX-License-Identifier: Apache-2.0
// CHECK(expression): ends the program with exit code 1 and a line that names what is wrong.
#pragma once

#include <cstdio>
#include <cstdlib>

#define CHECK(expression)                                                                 \
  do {                                                                                    \
    if (!(expression)) {                                                                  \
      std::fprintf(stderr, "%s:%d: CHECK(%s) failed\n", __FILE__, __LINE__, #expression); \
      std::exit(1);                                                                       \
    }                                                                                     \
  } while (false)
