// The kernels' text, embedded at build time, and its assembly into one source.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace kiloband::opencl {

/// Path as messages name it ("kernels/path/paths.cl", "src/shared/warp.h") to text.
using SourceMap = std::map<std::string, std::string, std::less<>>;

/// kernels/*.cl, kernels/*.clh and src/shared/*.h as they were when the program was built.
const SourceMap& embedded_sources();

/// One source text: the file `main` with its includes put in place (each file once: all have include guards),
/// with #line directives so that build logs name the file and line of the original.
/// Includes are looked for under kernels/, then src/. An include within a conditional is put in place too.
/// throws std::logic_error  a file is not there: "kernels/a.cl:3: no source 'b.clh'"
std::string assemble_source(const SourceMap& sources, std::string_view main);

/// Does a source's text name a macro anywhere but where it defines it? Names put together by ## and those of comments: they count as
/// they stand.
bool asks_for(std::string_view source, std::string_view macro);

}  // namespace kiloband::opencl
