// Sums over windows, a row of floats at a time. Private to register/icp.
#pragma once

#include <cstddef>

namespace enamel::pipeline {

/// out[i] = in[i] + in[i + step] + … , `terms` of them, in this order; count elements.
void sum_shifted(const float* in, std::size_t step, std::size_t terms, std::size_t count, float* out);

}  // namespace enamel::pipeline
