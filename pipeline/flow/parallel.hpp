// One job in many equal parts, after or beside a graph: where nothing streams, stages are not needed.
#pragma once

#include <cstddef>
#include <functional>

namespace enamel::flow {

/// work(n) for each n below count, once, on so many threads, the caller's among them; returns when all are done. Which
/// thread takes which n is left open: the result does not depend on it as long as each n writes to a place of its own.
/// work must not throw.
void for_each_index(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& work);

}  // namespace enamel::flow
