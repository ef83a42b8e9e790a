"use strict";(()=>{var l="https://linkwork.invalid/",f="/lib/python3.13/site-packages",d=["python_stdlib.zip","site.zip"];var h=`
from itertools import chain
from pathlib import Path

from linkwork_page import take, tell, turn
from pyodide.ffi import can_run_sync, run_sync

from linkwork.api import example_text, loads
from linkwork.viewer.live.browser_desk import BrowserDesk
from linkwork.viewer.live.bytecode import with_bytecode

STDLIB = Path("/lib/python313.zip")


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, pause)
begin, work = desk.begin, desk.work
steps = chain(
    with_bytecode(STDLIB, STDLIB, Path("/tmp/prepared-python_stdlib.zip")),
    with_bytecode(Path("/tmp/site.zip"), Path("${f}"), Path("/tmp/prepared-site.zip")),
)


def prepare():
    return next(steps, 0) is None
`,m=[],c=null,a=!1;self.onmessage=({data:e})=>{typeof e=="string"?(m.push(e),u()):P(e).catch(t=>self.postMessage({failed:String(t)}))};async function P({engine:e,files:t,fragment:n,kept:s,prepare:i}){p("Starting Python …"),self.fetch=r=>Promise.resolve(b(String(r),t));let o=await loadPyodide({indexURL:l,lockFileContents:e.lock,packageBaseUrl:l});p("Loading the solver …"),o.unpackArchive(t["site.zip"],"zip",{extractDir:f}),i&&o.FS.writeFile("/tmp/site.zip",new Uint8Array(t["site.zip"]));for(let r of Object.keys(t))delete t[r];let k=()=>m.splice(0);o.registerJsModule("linkwork_page",{take:k,tell:r=>self.postMessage(r),turn:y}),await o.runPythonAsync(h),p("Solving …");let[w,g]=[o.globals.get("begin"),o.globals.get("work")];w(n,s?.name??"",s?.saved??"",s?.text??""),c="Suspending"in WebAssembly?()=>g.callPromising():()=>Promise.resolve(g()),await u(),i&&v(o)}function v(e){let t=e.globals.get("prepare"),n=()=>{if(a)setTimeout(n,3e3);else if(t())setTimeout(n);else{let s=Object.fromEntries(d.map(i=>[i,e.FS.readFile(`/tmp/prepared-${i}`).buffer]));for(let i of d)e.FS.unlink(`/tmp/prepared-${i}`);e.FS.unlink("/tmp/site.zip"),self.postMessage({prepared:s},Object.values(s))}};setTimeout(n,3e3)}async function u(){if(!(a||c===null)){a=!0;try{for(;await c();)await y()}catch(e){self.postMessage({failed:String(e)})}a=!1}}function y(){return new Promise(e=>{let{port1:t,port2:n}=new MessageChannel;t.onmessage=()=>{t.close(),e()},n.postMessage(null)})}function b(e,t){let n=e.slice(l.length),s=n.endsWith(".wasm")?"application/wasm":"application/octet-stream",i=e.startsWith(l)?t[n]:void 0;return i?new Response(i,{headers:{"content-type":s}}):new Response(null,{status:404})}function p(e){self.postMessage({doing:e})}})();
