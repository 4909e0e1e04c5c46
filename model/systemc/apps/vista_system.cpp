// vista_system CONFIG OUT.json: simulates the system of a configuration (doc/design/system-model.md). `-` stands for
// standard input or standard output.

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "configuration.h"
#include "report.h"
#include "system.h"

namespace {

constexpr int kBadInput = 2;

vista::Configuration configuration_from(const std::string& path) {
  if (path == "-") return vista::read_configuration(std::cin);
  std::ifstream file(path);
  if (!file) throw vista::ConfigurationError(path, "cannot be read");
  return vista::read_configuration(file);
}

// Results go to PATH.part until the run is over: nothing half written stays.
class PartFile {
 public:
  PartFile(const std::string& key, const std::string& path) : key_(key), path_(path) {
    if (path.empty()) return;
    file_.open(part(), std::ios::binary);
    if (!file_) throw vista::ConfigurationError(key, path + " cannot be written");
  }
  std::ostream* stream() { return path_.empty() ? nullptr : &file_; }
  void keep() {
    if (path_.empty()) return;
    file_.close();
    if (!file_ || std::rename(part().c_str(), path_.c_str()) != 0)
      throw vista::ConfigurationError(key_, path_ + " cannot be written");
    kept_ = true;
  }
  ~PartFile() {
    if (!path_.empty() && !kept_) std::remove(part().c_str());
  }

 private:
  std::string part() const { return path_ + ".part"; }

  std::string key_, path_;
  std::ofstream file_;
  bool kept_ = false;
};

void simulate(const std::string& in, const std::string& out) {
  const vista::Configuration configuration = configuration_from(in);
  PartFile report("OUT.json", out == "-" ? "" : out), words("words_out", configuration.words_out);
  const vista::System system("system", configuration, words.stream());
  sc_core::sc_start();
  vista::write_report(system, out == "-" ? std::cout : *report.stream());
  words.keep();
  report.keep();
}

}  // namespace

int sc_main(int argc, char* argv[]) {
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  if (argc != 3) {
    std::cerr << "usage: vista_system CONFIG OUT.json\n";
    return kBadInput;
  }
  try {
    simulate(argv[1], argv[2]);
  } catch (const vista::ConfigurationError& error) {
    std::cerr << "vista_system: " << error.what() << "\n";
    return kBadInput;
  }
  return 0;
}

// Replaces the library's main: without its banner, which would stand before every error line.
int main(int argc, char* argv[]) {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
