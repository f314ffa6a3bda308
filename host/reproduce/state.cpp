#include "host/reproduce/stage.hpp"

#include "host/error.hpp"
#include "host/io/atomic_file.hpp"
#include "host/io/document_json.hpp"
#include "host/io/file.hpp"
#include "host/io/sha256.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace cowgpu::reproduce {
namespace {

constexpr const char* state_file = "data/stages.json";

// A file's hash, empty where it cannot be read.
std::string hash_of(const std::filesystem::path& path) {
  try {
    return sha256_hex(std::string_view(read_file(path)));
  } catch (const Error&) {
    return {};
  }
}

} // namespace

State::State(std::filesystem::path folder) : folder_(std::move(folder)) {
  try {
    const auto document = nlohmann::json::parse(read_file(folder_ / state_file));
    for (const auto& [name, entry] : document.at("stages").items())
      done_.emplace_back(name, Done{entry.at("key").get<std::string>(), entry.at("seconds").get<double>(),
                                    entry.at("sha256").get<std::vector<std::string>>()});
  } catch (const Error&) { // there is none
    done_.clear();
  } catch (const nlohmann::json::exception&) { // damaged: everything is run again
    done_.clear();
  }
}

std::vector<std::string> State::hashes(const Stage& stage) const {
  std::vector<std::string> found = {hash_of(folder_ / stage.output)};
  for (const std::string& file : stage.files) found.push_back(hash_of(folder_ / file));
  return found;
}

std::optional<Done> State::finished(const Stage& stage, const std::string& key) const {
  for (const auto& [name, done] : done_)
    if (name == stage.name && done.key == key && done.hashes == hashes(stage)) return done;
  return {};
}

void State::finish(const Stage& stage, const std::string& key, double seconds) {
  std::erase_if(done_, [&](const auto& entry) { return entry.first == stage.name; });
  done_.emplace_back(stage.name, Done{key, seconds, hashes(stage)});
  Object stages;
  for (const auto& [name, done] : done_)
    stages.add(name, Object{{"key", done.key}, {"seconds", done.seconds}, {"sha256", done.hashes}});
  AtomicFile file(folder_ / state_file);
  file.write(json_text({{"schema", "cowgpu.stages.v1"}, {"stages", stages}}));
  file.commit();
}

std::string stage_key(const Stage& stage, const std::string& program) {
  std::string all = program;
  for (const std::string& argument : stage.arguments) all += '\0' + argument;
  return sha256_hex(std::string_view(all));
}

} // namespace cowgpu::reproduce
