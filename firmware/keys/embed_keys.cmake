# cmake -DKEYS=a.pub;b.pub -DOUT=trusted_keys.cpp -P embed_keys.cmake: public key files of enamel-sign as C++.
# Stops with the file's name for whatever is no public key; a secret one is never copied.
cmake_minimum_required(VERSION 3.25)

list(LENGTH KEYS count)
if(count LESS 1 OR count GREATER 32)
  message(FATAL_ERROR "ENAMEL_FIRMWARE_KEYS names ${count} keys: 1 to 32 are possible, one bit each of `revoked`")
endif()

set(entries "")
set(seen "")
foreach(file IN LISTS KEYS)
  if(NOT EXISTS "${file}")
    message(FATAL_ERROR "${file}: no such key file. Give the absolute path of a *.pub that `enamel-sign keygen` wrote.")
  endif()
  file(READ "${file}" text)
  foreach(field format kind key development)
    string(JSON ${field} ERROR_VARIABLE bad GET "${text}" ${field})
    if(bad)
      message(FATAL_ERROR "${file}: no key file of enamel-sign (${bad})")
    endif()
  endforeach()
  if(NOT format STREQUAL "enamel-key/1" OR NOT kind STREQUAL "public")
    message(FATAL_ERROR "${file}: holds a ${kind} key of format ${format}; give the *.pub beside it")
  endif()
  string(LENGTH "${key}" digits)
  if(NOT digits EQUAL 64 OR NOT key MATCHES "^[0-9a-f]+$")
    message(FATAL_ERROR "${file}: a key has 64 hexadecimal digits, this one ${digits}")
  endif()
  if(key IN_LIST seen)
    message(FATAL_ERROR "${file}: the same key is named twice")
  endif()
  list(APPEND seen ${key})
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1, " bytes ${key})
  if(development)
    set(development true)
  else()
    set(development false)
  endif()
  string(APPEND entries "    {{${bytes}}, ${development}},\n")
endforeach()

file(WRITE "${OUT}" "// Made by firmware/keys/embed_keys.cmake.
#include \"firmware/keys/trusted_keys.hpp\"

namespace enamel::fw {
namespace {
constexpr image::TrustedKey kKeys[] = {
${entries}};
}  // namespace
std::span<const image::TrustedKey> trusted_keys() noexcept { return kKeys; }
}  // namespace enamel::fw
")
