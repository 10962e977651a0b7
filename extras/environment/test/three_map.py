"""python3 three_map.py FOLDER: renders each scene of FOLDER/scenes.json with three.js.

A scene shows a plane of 2 x 2 about the origin, which faces +z. FOLDER contains three.js and the other files that a page needs. The script
writes the radiance of scene i as FOLDER/i.rgba, in 32-bit floats, with the top row first.
"""
import base64
import json
import os
import sys

from three_site import Site

folder = sys.argv[1]
chromium = Site(folder).chromium
chromium.run("""(async () => {
    window.THREE = await import('three');
    window.scenes = await (await fetch('scenes.json')).json();
    window.draw = async (given) => {
        const module = await import(`./${given.module}.js`), scene = new THREE.Scene();
        const material = new module[given.class](), renderer = new THREE.WebGLRenderer();
        if (given.is_map) {
            const texture = material.coefficients = await module.loadCoefficients();
            if (given.repeat) {
                texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
                texture.repeat.set(...given.repeat), texture.offset.set(...given.offset), texture.rotation = given.rotation;
            }
        }
        // A clone as it is loaded from a scene.
        scene.add(new THREE.Mesh(new THREE.PlaneGeometry(2, 2), given.is_map ? material.clone() : material));
        const light = new THREE.DirectionalLight('white', 2);
        light.position.set(...given.towards);
        scene.add(light);
        if (given.more_lights) {
            const lamp = new THREE.PointLight('orange', 5);
            lamp.position.set(0.5, 0.5, 1);
            scene.add(lamp, new THREE.HemisphereLight('white', 'green', 0.7), new THREE.AmbientLight('white', 0.2));
        }
        if (given.environment) {
            const sky = new Float32Array(4 * 64 * 32);
            for (let y = 0; y < 32; ++y)
                for (let x = 0; x < 64; ++x) sky.set([y / 32, 0.5, 1 - x / 64, 1].map((c) => c + 9 * (Math.hypot(x - 48, y - 24) < 4)), 4 * (64 * y + x));
            scene.environment = new THREE.DataTexture(sky, 64, 32, THREE.RGBAFormat, THREE.FloatType, THREE.EquirectangularReflectionMapping);
            scene.environment.minFilter = scene.environment.magFilter = THREE.LinearFilter;
            scene.environment.needsUpdate = true;
            const box = new THREE.RectAreaLight('white', 4, 1, 1);
            box.position.set(-1, 1, 1), box.lookAt(0, 0, 0);
            scene.add(box);
        }
        const camera = given.fov ? new THREE.PerspectiveCamera(given.fov, 1, 0.01, 100) : new THREE.OrthographicCamera(-1, 1, 1, -1, 0.01, 100);
        camera.position.set(...given.eye);
        camera.lookAt(0, 0, 0);
        const target = new THREE.WebGLRenderTarget(given.size, given.size, { type: THREE.FloatType, colorSpace: THREE.LinearSRGBColorSpace });
        renderer.setRenderTarget(target);
        renderer.render(scene, camera);
        const pixels = new Float32Array(4 * given.size * given.size);
        renderer.readRenderTargetPixels(target, 0, 0, given.size, given.size, pixels);
        const rows = new Uint8Array(pixels.buffer), width = 16 * given.size;
        let text = '';
        for (let y = given.size; y-- > 0;) text += String.fromCharCode(...rows.subarray(width * y, width * (y + 1)));
        renderer.dispose();
        return btoa(text);
    };
})()""")
for i in range(chromium.run("scenes.length")):
    with open(os.path.join(folder, f"{i}.rgba"), "wb") as file:
        file.write(base64.b64decode(chromium.run(f"draw(scenes[{i}])")))
checks = chromium.run("""(async () => {
    const { AloneMaterial } = await import('./alone.js'), { warn } = console, said = [];
    const plain = new AloneMaterial(), changed = new AloneMaterial();
    changed.onBeforeCompile = (shader) => shader;
    console.warn = (text) => said.push(text);
    const scene = new THREE.Scene(), camera = new THREE.OrthographicCamera(-1, 1, 1, -1), lamp = new THREE.DirectionalLight('white', 2);
    camera.position.set(0.5, 0.5, 1), camera.lookAt(0, 0, 0), lamp.position.set(1, 2, 2);
    scene.add(new THREE.Mesh(new THREE.PlaneGeometry(), new AloneMaterial({ color: 'orange', saturation: 0.5 })), lamp);
    scene.updateMatrixWorld();
    const renderer = new THREE.WebGLRenderer(), target = new THREE.WebGLRenderTarget(8, 8, { type: THREE.FloatType });
    const [saved, loaded] = [scene, new THREE.ObjectLoader().parse(JSON.parse(JSON.stringify(scene.toJSON())))].map((shown) => {
        const pixels = new Float32Array(256);
        renderer.setRenderTarget(target);
        renderer.render(shown, camera);
        renderer.readRenderTargetPixels(target, 0, 0, 8, 8, pixels);
        return pixels;
    });
    console.warn = warn;
    return { said, is_loaded: saved[144] > 0 && saved.every((x, i) => x === loaded[i]), share_a_program: plain.customProgramCacheKey() === changed.customProgramCacheKey() };
})()""")
print(json.dumps({"problems": chromium.problems, **checks}))
chromium.close()
