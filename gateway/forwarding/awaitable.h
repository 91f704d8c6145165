// boost/asio/awaitable.hpp, which in Boost 1.74 uses std::exchange without including <utility>.
// Include this instead, before any other header of Boost.Asio.
#pragma once

// clang-format off
#include <utility>
#include <boost/asio/awaitable.hpp>
// clang-format on
