// Renders a scene with the hemiray library, then asks its acceleration structure what a ray hits.
// Usage: embed SCENE OUTPUT.png
#include <exception>
#include <hemiray/hemiray.hpp>
#include <iostream>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: embed SCENE OUTPUT.png\n";
    return 2;
  }
  try {
    hemiray::Context context;  // the default device
    const hemiray::Scene scene = hemiray::Scene::load(argv[1]);

    hemiray::RenderOptions options;
    options.width = 64;
    options.height = 64;
    options.samples_per_pixel = 1;
    const hemiray::Image image = hemiray::render(context, scene, options);
    image.write_png(argv[2]);
    std::cout << "rendered " << image.width() << " x " << image.height() << " pixels\n";

    // One ray straight down the camera's axis, through the middle of the scene.
    const hemiray::Accel accel(context, scene);
    const std::vector<hemiray::Ray> rays{scene.camera_ray(0.5, 0.5)};
    const std::vector<hemiray::Hit> hits = accel.intersect(rays);
    if (!hits.front().found()) {
      std::cerr << "the middle of the picture shows nothing\n";
      return 1;
    }
    std::cout << "the middle of the picture is " << hits.front().t << " m away\n";
  } catch (const std::exception& error) {
    std::cerr << "embed: " << error.what() << '\n';
    return 1;
  }
}
