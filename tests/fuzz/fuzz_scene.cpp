// The reader of scenes: any text is a scene or refused in one line, and what is a scene is written and read again as the same one.
#include <string>

#include "harness.h"
#include "openclose/scene/check.h"
#include "openclose/scene/reader.h"
#include "openclose/scene/writer.h"

using namespace openclose;

namespace {

/// A domain may ask for a million blocks within its rights; so many only take time here.
std::vector<std::string> overrides_for(const std::string& text) {
  if (text.find("domain") == std::string::npos) return {};
  return {"domain.max_blocks=300"};
}

void read_and_write(const std::string& text) {
  const Scene scene = scene_of_text(text, "scene.toml", overrides_for(text));
  const std::string written = write_scene(scene);
  const Scene again = scene_of_text(written, "scene.toml");
  require_promise(write_scene(again) == written, "a scene that was written reads back as the same one");
  check_scene(scene);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    read_and_write(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const InputError& error) {
    const std::string message = error.what();
    require_promise(message.find('\n') == std::string::npos, "a message is one line");
    require_promise(message.find("scene.toml") != std::string::npos, "a message names the file");
  }
  return 0;
}
