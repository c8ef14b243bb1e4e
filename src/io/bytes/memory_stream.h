// Memory as C++ streams: OpenVDB writes into one and reads from the other.
#pragma once

#include <cstring>
#include <istream>
#include <ostream>
#include <streambuf>
#include <vector>

#include "isoshell/advanced/buffer.h"

namespace isoshell {

/// Grows as it is written; can be sought, so that offsets can be filled in afterwards.
class MemorySink : public std::streambuf {
 public:
  std::vector<char>& bytes() { return bytes_; }

 protected:
  std::streamsize xsputn(const char* data, std::streamsize count) override {
    if (at_ + size_t(count) > bytes_.size()) bytes_.resize(at_ + size_t(count));
    std::memcpy(bytes_.data() + at_, data, size_t(count));
    at_ += size_t(count);
    return count;
  }
  int_type overflow(int_type c) override {
    const char one = traits_type::to_char_type(c);
    xsputn(&one, 1);
    return c;
  }
  pos_type seekoff(off_type by, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type base = from == std::ios_base::beg ? 0 : off_type(from == std::ios_base::cur ? at_ : bytes_.size());
    return seekpos(base + by, std::ios_base::out);
  }
  pos_type seekpos(pos_type to, std::ios_base::openmode) override {
    if (off_type(to) < 0 || off_type(to) > off_type(bytes_.size())) return pos_type(off_type(-1));
    at_ = size_t(off_type(to));
    return to;
  }

 private:
  std::vector<char> bytes_;
  size_t at_ = 0;
};

/// Two pieces of memory read as if one followed the other. Only forward.
class MemorySource : public std::streambuf {
 public:
  MemorySource(View<const char> first, View<const char> second) : second_(second) { show(first); }

 protected:
  int_type underflow() override {
    if (gptr() == egptr() && !second_.empty()) {
      show(second_);
      second_ = {};
    }
    return gptr() == egptr() ? traits_type::eof() : traits_type::to_int_type(*gptr());
  }

 private:
  // The buffer's interface is not const, yet nothing writes through it: putback is not offered.
  void show(View<const char> piece) {
    char* begin = const_cast<char*>(piece.data);
    setg(begin, begin, begin + piece.size);
  }

  View<const char> second_;
};

}  // namespace isoshell
