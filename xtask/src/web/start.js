const embedded = (id) => document.getElementById(id).textContent;
const start = (program, id) => {
  const wasm = Uint8Array.from(atob(embedded(id)), (c) => c.charCodeAt(0));
  return program({ module_or_path: wasm });
};

// The other programs lie in the file as text; their glue becomes a script when it is wanted.
const programs = {};
const load = async (name) => {
  const script = document.createElement('script');
  script.textContent = `${embedded(`${name}-glue`)}\nwindow.valvescopeGlue = ${name};`;
  document.head.append(script);
  const program = window.valvescopeGlue;
  await start(program, name);
  return program;
};
window.valvescopeProgram = (name) => (programs[name] ??= load(name));

start(valvescope, 'program');
