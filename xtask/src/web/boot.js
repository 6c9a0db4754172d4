import init from './valvescope.js';

const programs = {};
let attempts = 0;

// Loads another program of the page, once. A failure is forgotten, so that it can be tried again.
window.valvescopeProgram = (name) => {
  programs[name] ??= load(name).catch((error) => {
    delete programs[name];
    throw error;
  });
  return programs[name];
};

async function load(name) {
  // A browser may remember that it could not fetch a module; another query is another module.
  const query = attempts++ ? `?${attempts}` : '';
  const program = await import(`./${name}.js${query}`);
  await program.default();
  return program;
}

init();
