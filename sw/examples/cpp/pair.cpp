// One rectified stereo pair from two PGM files: matches it and prints how far away the obstacles in it are.
//   pair LEFT.pgm RIGHT.pgm FOCAL_PX BASELINE_M
#include <vista/vista.h>

#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

struct Image {
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> grey;
};

Image read_pgm(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  Image image;
  int white = 0;
  if (!(file >> magic >> image.width >> image.height >> white) || magic != "P5" || white != 255 || image.width < 1 ||
      image.height < 1 || image.width > VISTA_MOST_IMAGE_PX || image.height > VISTA_MOST_IMAGE_PX)
    throw std::runtime_error(path + ": not a binary PGM file with 8 bits a pixel");
  file.get();  // the line's end
  image.grey.resize(static_cast<std::size_t>(image.width) * image.height);
  if (!file.read(reinterpret_cast<char*>(image.grey.data()), static_cast<std::streamsize>(image.grey.size())))
    throw std::runtime_error(path + ": cut off");
  return image;
}

void check(vista_status status) {
  if (status != VISTA_OK) throw std::runtime_error(vista_status_text(status));
}

void run(const std::string& left_path, const std::string& right_path, double focal_px, double baseline_m) {
  const Image left = read_pgm(left_path), right = read_pgm(right_path);
  if (left.width != right.width || left.height != right.height) throw std::runtime_error("the images differ in size");

  vista_parameters parameters = vista_parameters_default();
  check(vista_parameters_set_choice(&parameters, "stereo.smooth", "binomial3"));
  vista_rig rig{};  // without tables: the images come rectified
  rig.camera = {left.width, left.height, focal_px, (left.width - 1) / 2.0, (left.height - 1) / 2.0, baseline_m};
  vista_detector_options options{};
  options.stills = true;  // one pair has to do
  std::size_t bytes = 0;
  check(vista_detector_bytes(&parameters, &rig, &options, &bytes));
  std::vector<unsigned char> memory(bytes);
  vista_detector* detector = nullptr;
  check(vista_detector_create(memory.data(), bytes, &parameters, &rig, &options, &detector));

  vista_detector_pair pair{};
  pair.left = {left.grey.data(), left.width, left.height, left.width};
  pair.right = {right.grey.data(), right.width, right.height, right.width};
  const vista_detector_place place{};  // neither pose nor direction is known
  vista_novelty novelty;
  vista_detector_result found;
  check(vista_detector_process(detector, &pair, &place, &novelty, &found));
  const vista_result& result = found.result;

  std::cout << "libvista " << vista_version() << ": " << 100.0 * result.valid_fraction << " % of the pixels matched\n";
  for (std::int32_t i = 0; i < result.obstacle_count; ++i) {
    const vista_obstacle& obstacle = *vista_result_obstacle(&result, i);
    if (obstacle.confirmed)
      std::cout << "obstacle at " << obstacle.distance_m << " m, " << obstacle.extent_m[0] << " m wide and "
                << obstacle.extent_m[1] << " m high\n";
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) throw std::runtime_error("usage: pair LEFT.pgm RIGHT.pgm FOCAL_PX BASELINE_M");
  run(argv[1], argv[2], std::stod(argv[3]), std::stod(argv[4]));
  return 0;
} catch (const std::exception& error) {
  std::cerr << "pair: " << error.what() << '\n';
  return 1;
}
