"""python3 three.py FOLDER: renders the scenes of FOLDER/scenes.json with three.js.

FOLDER contains three.js and the other files that a page needs. The script writes the picture of scene i as FOLDER/i.rgba, with the top row
first, and a picture of the page of examples/ as FOLDER/example.png.
"""
import base64
import json
import os
import sys

from three_site import Site

folder = sys.argv[1]
site = Site(folder)
chromium = site.chromium
chromium.run("""(async () => {
    window.THREE = await import('three');
    window.materials = await import('./materials.js');
    window.scenes = await (await fetch('scenes.json')).json();
    // The tone mapping of the desktop's pictures.
    THREE.ShaderChunk.tonemapping_pars_fragment = THREE.ShaderChunk.tonemapping_pars_fragment.replace(
        /vec3 CustomToneMapping\\([^}]*}/, `vec3 CustomToneMapping(vec3 color) {
            vec3 x = toneMappingExposure * color;
            float peak = max(x.x, max(x.y, x.z));
            if (peak <= 0.76) return x;
            float bent = 1.0 - 0.24 * 0.24 / (peak + 1.0 - 2.0 * 0.76);
            return mix(x * bent / peak, vec3(bent), 1.0 - 1.0 / (1.0 + 0.15 * (peak - bent)));
        }`);
})()""")
for i in range(chromium.run("scenes.length")):
    pixels = chromium.run("""((given) => {
        const numbers = (text, type) => new type(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
        const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true }), scene = new THREE.Scene();
        renderer.setSize(given.width, given.height);
        renderer.toneMapping = THREE.CustomToneMapping;
        renderer.toneMappingExposure = given.exposure;
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute('position', new THREE.BufferAttribute(numbers(given.positions, Float32Array), 3));
        geometry.setAttribute('normal', new THREE.BufferAttribute(numbers(given.normals, Float32Array), 3));
        geometry.setIndex(new THREE.BufferAttribute(numbers(given.triangles, Uint32Array), 1));
        const material = new materials[given.material]();
        if (given.many) {  // as an instance
            const mesh = new THREE.InstancedMesh(geometry, material, 1);
            mesh.setMatrixAt(0, new THREE.Matrix4());
            scene.add(mesh);
        } else {
            scene.add(new THREE.Mesh(geometry, material));
        }
        for (const { towards, irradiance } of given.lights) {
            const light = new THREE.DirectionalLight(new THREE.Color(...irradiance));
            light.position.set(...towards);
            scene.add(light);
        }
        const camera = new THREE.PerspectiveCamera(given.fov, given.width / given.height, 0.01, 1000);
        camera.position.set(...given.eye);
        camera.lookAt(...given.target);
        renderer.render(scene, camera);
        const gl = renderer.getContext(), rows = new Uint8Array(4 * given.width * given.height);
        gl.readPixels(0, 0, given.width, given.height, gl.RGBA, gl.UNSIGNED_BYTE, rows);
        let text = "";
        for (let y = given.height; y-- > 0;) text += String.fromCharCode(...rows.subarray(4 * given.width * y, 4 * given.width * (y + 1)));
        renderer.dispose();
        return btoa(text);
    })(scenes[%d])""" % i)
    with open(os.path.join(folder, f"{i}.rgba"), "wb") as file:
        file.write(base64.b64decode(pixels))
# A model that is Lambert's formula beside three's own material of it: skinned, instanced, under every kind of light, with
# shadows, fog and a tone mapping.
alike = chromium.run("""(() => {
    const picture = (make) => {
        const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true }), scene = new THREE.Scene();
        renderer.setSize(320, 240);
        renderer.toneMapping = THREE.ACESFilmicToneMapping;
        renderer.shadowMap.enabled = true;
        scene.fog = new THREE.Fog(0x406080, 2, 14);
        const add = (mesh) => { mesh.castShadow = mesh.receiveShadow = true; scene.add(mesh); return mesh; };
        const limb = new THREE.CylinderGeometry(0.3, 0.3, 2, 24, 16), indices = [], weights = [];
        for (let i = 0; i < limb.attributes.position.count; ++i) {
            const up = Math.min(Math.max(limb.attributes.position.getY(i) / 2 + 0.5, 0), 1);
            indices.push(0, 1, 0, 0), weights.push(1 - up, up, 0, 0);
        }
        limb.setAttribute('skinIndex', new THREE.Uint16BufferAttribute(indices, 4));
        limb.setAttribute('skinWeight', new THREE.Float32BufferAttribute(weights, 4));
        const skinned = add(new THREE.SkinnedMesh(limb, make())), bones = [new THREE.Bone(), new THREE.Bone()];
        bones[0].position.y = -1, bones[1].position.y = 1, bones[0].add(bones[1]), skinned.add(bones[0]);
        skinned.bind(new THREE.Skeleton(bones));
        bones[1].rotation.z = 1;
        const many = add(new THREE.InstancedMesh(new THREE.TorusKnotGeometry(0.3, 0.1, 96, 16), make(), 2));
        [-1.5, 1.5].forEach((x, i) => many.setMatrixAt(i, new THREE.Matrix4().makeTranslation(x, 0.3 * x, 0)));
        add(new THREE.Mesh(new THREE.PlaneGeometry(9, 9), make())).rotation.x = -Math.PI / 2;
        scene.children.at(-1).position.y = -1.1;
        const sun = new THREE.DirectionalLight('white', 2), spot = new THREE.SpotLight('orange', 60), point = new THREE.PointLight('cyan', 20);
        sun.position.set(2, 4, 3), spot.position.set(-3, 3, 2), point.position.set(0, 2, -2);
        for (const light of [sun, spot, point]) light.castShadow = true, scene.add(light);
        scene.add(new THREE.HemisphereLight('white', 'green', 0.7), new THREE.AmbientLight('white', 0.2));
        const camera = new THREE.PerspectiveCamera(40, 4 / 3, 0.1, 100);
        camera.position.set(0, 1.5, 6), camera.lookAt(0, 0, 0);
        renderer.render(scene, camera);
        const gl = renderer.getContext(), pixels = new Uint8Array(4 * 320 * 240);
        gl.readPixels(0, 0, 320, 240, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        renderer.dispose();
        return pixels;
    };
    const colour = new THREE.Color().setRGB(0.5, 0.25, 0.125);
    const pictures = [() => new THREE.MeshLambertMaterial({ color: colour }), () => new materials.LambertMaterial()].map(picture);
    const squares = pictures[0].reduce((sum, x, i) => sum + (x - pictures[1][i]) ** 2, 0);
    return { psnr: 10 * Math.log10(255 * 255 * pictures[0].length / Math.max(squares, 1e-3)), colours: new Set(pictures[0]).size };
})()""")
# Blends beside the materials that they mix: the largest difference of linear pictures, relative to the largest value; and how
# many programs changes of numbers compile.
blend = chromium.run("""(() => {
    const renderer = new THREE.WebGLRenderer(), scene = new THREE.Scene(), size = 48, { BlendMaterial } = materials;
    const target = new THREE.WebGLRenderTarget(size, size, { type: THREE.FloatType });
    const geometry = new THREE.SphereGeometry(1, 32, 24), count = geometry.attributes.position.count;
    geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(3 * count).map((_, i) => [0.5, 0.25, 0][i % 3]), 3));
    const mesh = new THREE.Mesh(geometry), sun = new THREE.DirectionalLight('white', 2), area = new THREE.RectAreaLight('orange', 3, 1, 1);
    sun.position.set(2, 4, 3), area.position.set(-2, 2, 2), area.lookAt(0, 0, 0);
    const sky = Uint16Array.from({ length: 4 * 32 * 16 }, (_, i) => THREE.DataUtils.toHalfFloat(i % 4 === 3 ? 1 : (i / 700) % 1));
    const environment = (texels) => {
        const map = new THREE.DataTexture(texels, 32, 16, THREE.RGBAFormat, THREE.HalfFloatType, THREE.EquirectangularReflectionMapping);
        map.needsUpdate = true;
        return map;
    };
    scene.environment = environment(sky);
    scene.add(mesh, sun, area, new THREE.AmbientLight('white', 0.2));
    const camera = new THREE.PerspectiveCamera(40, 1, 0.1, 100);
    camera.position.set(0, 0, 3.5);
    const picture = (material) => {
        mesh.material = material;
        renderer.setRenderTarget(target), renderer.clear(), renderer.render(scene, camera);
        const pixels = new Float32Array(4 * size * size);
        renderer.readRenderTargetPixels(target, 0, 0, size, size, pixels);
        return pixels;
    };
    const relative_difference = (a, b) => a.reduce((most, x, i) => Math.max(most, Math.abs(x - b[i])), 0) / b.reduce((most, x) => Math.max(most, x), 0);
    const mixed = (weights, pictures) => pictures[0].map((_, i) => weights.reduce((sum, w, k) => sum + w * pictures[k][i], 0));
    const [film, ggx, lambert] = ['Film', 'Ggx', 'Lambert'].map((name) => new materials[name + 'Material']());
    const single = [film, ggx, lambert].map(picture), found = {};
    // A function of the page's own, which halves the light and calls the material's as other pages do.
    const halved = new materials.FilmMaterial(), patched = halved.onBeforeCompile;
    halved.onBeforeCompile = (shader, renderer) => {
        patched(shader, renderer);
        shader.fragmentShader = shader.fragmentShader.replace('#include <opaque_fragment>', 'outgoingLight *= 0.5;\\n$&');
    };
    found.own_function = relative_difference(picture(halved), single[0].map((x, i) => i % 4 < 3 ? 0.5 * x : x));
    const blended = new BlendMaterial(film, ggx, lambert, { shares: [0.2, 0.3, 0.5] });
    found.shares = relative_difference(picture(blended), mixed([0.2, 0.3, 0.5], single));
    found.vertices = relative_difference(picture(new BlendMaterial(film, ggx, lambert, { vertexMask: true })), mixed([0.25, 0.5, 0.25], single));
    const mask = new THREE.DataTexture(new Uint8Array([0, 0, 0, 255, 255, 0, 0, 255]), 2, 1);
    mask.needsUpdate = true, mask.repeat.set(4, 1), mask.wrapS = THREE.RepeatWrapping;
    const masked = picture(new BlendMaterial(film, lambert, { mask })), from_film = (i) => Math.abs(masked[i] - single[0][i]), from_lambert = (i) => Math.abs(masked[i] - single[2][i]);
    found.mask = masked.reduce((most, _, i) => Math.max(most, Math.min(from_film(i), from_lambert(i))), 0) / single[0].reduce((most, x) => Math.max(most, x), 0);
    found.chosen = ['film', 'lambert'].filter((_, k) => masked.some((_, i) => (k ? from_lambert : from_film)(i) < 1e-6 && (k ? from_film : from_lambert)(i) > 0.01)).length;
    const programs = renderer.info.programs.length;
    film.color.setRGB(0.5, 1, 0.25), blended.shares = [1, 0, 0];
    found.tint = relative_difference(picture(blended), single[0].map((x, i) => x * [0.5, 1, 0.25, 1][i % 4]));
    found.tint_alone = relative_difference(picture(film), single[0].map((x, i) => x * [0.5, 1, 0.25, 1][i % 4]));
    // Without saturation a channel is what it is when all channels of the lights are as that one.
    film.color.set('white'), film.saturation = 0;
    const coloured = picture(blended), orange = area.color.clone(), white = single[0].reduce((most, x) => Math.max(most, x), 0);
    found.grey = [0, 1, 2].reduce((most, c) => {
        area.color.setScalar(orange.toArray()[c]);
        scene.environment = environment(sky.map((_, i) => sky[i - i % 4 + (i % 4 < 3 ? c : 3)]));
        const grey = picture(blended);
        return coloured.reduce((found, x, i) => i % 4 > 2 ? found : Math.max(found, Math.abs(grey[i] - coloured[i - i % 4 + c])), most);
    }, 0) / white;
    const compiled = renderer.info.programs.length - programs;
    renderer.dispose();
    const { chosen, ...worst } = found;
    return { worst, chosen, compiled };
})()""")
problems = list(chromium.problems)
if os.path.exists(os.path.join(folder, "three.html")):
    chromium.size(1016, 516)
    site.visit("three.html")
    chromium.screenshot(os.path.join(folder, "example.png"))
    problems += [p for p in chromium.problems if "favicon" not in json.dumps(p) and p not in problems]
print(json.dumps({"problems": problems, "blend": blend, **alike}))
chromium.close()
