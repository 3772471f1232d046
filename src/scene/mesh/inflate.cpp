#include "scene/mesh/inflate.hpp"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "base/error.hpp"

namespace kiloband {

struct InflateStream::State {
  z_stream zlib{};
  const char* end = nullptr;  // of the compressed bytes
  bool finished = false;
};

namespace {

// zlib counts in 32 bits: both sides are fed in pieces.
uInt piece(size_t bytes) {
  return static_cast<uInt>(std::min<size_t>(bytes, std::numeric_limits<uInt>::max()));
}

}  // namespace

InflateStream::InflateStream(const MeshFile& file, size_t begin, size_t end)
    : file_(file), state_(std::make_unique<State>()) {
  // zlib's input pointer is not const for historical reasons; it does not write there.
  state_->zlib.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(file.bytes.data() + begin));
  state_->end = file.bytes.data() + end;
  if (inflateInit(&state_->zlib) != Z_OK) throw DeviceError("zlib: inflateInit failed, out of memory");
}

InflateStream::~InflateStream() {
  inflateEnd(&state_->zlib);
}

size_t InflateStream::offset() const {
  return static_cast<size_t>(reinterpret_cast<const char*>(state_->zlib.next_in) - file_.bytes.data());
}

size_t InflateStream::limit() const {
  // DEFLATE expands at most 1032 times (258 bytes from 2 bits);
  // what zlib holds back is below its window of 32 KiB.
  constexpr size_t kMostExpansion = 1032, kWindow = 32768;
  const auto left = static_cast<size_t>(state_->end - reinterpret_cast<const char*>(state_->zlib.next_in));
  return kMostExpansion * (left + 1) + kWindow;
}

void InflateStream::read(void* target, size_t bytes) {
  z_stream& zlib = state_->zlib;
  zlib.next_out = static_cast<Bytef*>(target);
  while (bytes > 0) {
    if (state_->finished) file_.fail_byte(offset(), "the zlib stream ends too early");
    zlib.avail_in = piece(static_cast<size_t>(state_->end - reinterpret_cast<const char*>(zlib.next_in)));
    zlib.avail_out = piece(bytes);
    const uInt asked = zlib.avail_out;
    const int status = inflate(&zlib, Z_NO_FLUSH);
    bytes -= asked - zlib.avail_out;
    if (status == Z_STREAM_END) {
      state_->finished = true;
    } else if (status == Z_BUF_ERROR) {
      file_.fail_byte(offset(), "the zlib stream is cut off");
    } else if (status == Z_MEM_ERROR) {
      throw DeviceError("zlib: inflate is out of memory");
    } else if (status != Z_OK) {
      file_.fail_byte(offset(),
                      std::string("bad zlib stream: ") + (zlib.msg ? zlib.msg : "it needs a dictionary"));
    }
  }
}

void InflateStream::expect_end() {
  z_stream& zlib = state_->zlib;
  if (state_->finished) return;
  Bytef extra = 0;
  zlib.next_out = &extra;
  zlib.avail_out = 1;
  zlib.avail_in = piece(static_cast<size_t>(state_->end - reinterpret_cast<const char*>(zlib.next_in)));
  const int status = inflate(&zlib, Z_FINISH);
  if (zlib.avail_out == 0) file_.fail_byte(offset(), "the zlib stream holds more than the mesh");
  if (status == Z_DATA_ERROR)
    file_.fail_byte(offset(), std::string("bad zlib stream: ") + (zlib.msg ? zlib.msg : "damaged"));
  if (status != Z_STREAM_END) file_.fail_byte(offset(), "the zlib stream is cut off");
}

}  // namespace kiloband
