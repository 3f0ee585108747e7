//! Made by `make bindings` from the header of Ipopt 3.11.

pub type Number = f64;
pub type Index = std::ffi::c_int;
pub type Int = std::ffi::c_int;
pub const Solve_Succeeded: ApplicationReturnStatus = 0;
pub const Solved_To_Acceptable_Level: ApplicationReturnStatus = 1;
pub const Infeasible_Problem_Detected: ApplicationReturnStatus = 2;
pub const Search_Direction_Becomes_Too_Small: ApplicationReturnStatus = 3;
pub const Diverging_Iterates: ApplicationReturnStatus = 4;
pub const User_Requested_Stop: ApplicationReturnStatus = 5;
pub const Feasible_Point_Found: ApplicationReturnStatus = 6;
pub const Maximum_Iterations_Exceeded: ApplicationReturnStatus = -1;
pub const Restoration_Failed: ApplicationReturnStatus = -2;
pub const Error_In_Step_Computation: ApplicationReturnStatus = -3;
pub const Maximum_CpuTime_Exceeded: ApplicationReturnStatus = -4;
pub const Not_Enough_Degrees_Of_Freedom: ApplicationReturnStatus = -10;
pub const Invalid_Problem_Definition: ApplicationReturnStatus = -11;
pub const Invalid_Option: ApplicationReturnStatus = -12;
pub const Invalid_Number_Detected: ApplicationReturnStatus = -13;
pub const Unrecoverable_Exception: ApplicationReturnStatus = -100;
pub const NonIpopt_Exception_Thrown: ApplicationReturnStatus = -101;
pub const Insufficient_Memory: ApplicationReturnStatus = -102;
pub const Internal_Error: ApplicationReturnStatus = -199;
pub type ApplicationReturnStatus = std::ffi::c_int;
#[repr(C)]
#[derive(Debug)]
pub struct IpoptProblemInfo {
    _unused: [u8; 0],
}
pub type IpoptProblem = *mut IpoptProblemInfo;
pub type Bool = std::ffi::c_int;
pub type UserDataPtr = *mut std::ffi::c_void;
pub type Eval_F_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: Index,
        x: *mut Number,
        new_x: Bool,
        obj_value: *mut Number,
        user_data: UserDataPtr,
    ) -> Bool,
>;
pub type Eval_Grad_F_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: Index,
        x: *mut Number,
        new_x: Bool,
        grad_f: *mut Number,
        user_data: UserDataPtr,
    ) -> Bool,
>;
pub type Eval_G_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: Index,
        x: *mut Number,
        new_x: Bool,
        m: Index,
        g: *mut Number,
        user_data: UserDataPtr,
    ) -> Bool,
>;
pub type Eval_Jac_G_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: Index,
        x: *mut Number,
        new_x: Bool,
        m: Index,
        nele_jac: Index,
        iRow: *mut Index,
        jCol: *mut Index,
        values: *mut Number,
        user_data: UserDataPtr,
    ) -> Bool,
>;
pub type Eval_H_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: Index,
        x: *mut Number,
        new_x: Bool,
        obj_factor: Number,
        m: Index,
        lambda: *mut Number,
        new_lambda: Bool,
        nele_hess: Index,
        iRow: *mut Index,
        jCol: *mut Index,
        values: *mut Number,
        user_data: UserDataPtr,
    ) -> Bool,
>;
pub type Intermediate_CB = ::std::option::Option<
    unsafe extern "C" fn(
        alg_mod: Index,
        iter_count: Index,
        obj_value: Number,
        inf_pr: Number,
        inf_du: Number,
        mu: Number,
        d_norm: Number,
        regularization_size: Number,
        alpha_du: Number,
        alpha_pr: Number,
        ls_trials: Index,
        user_data: UserDataPtr,
    ) -> Bool,
>;
unsafe extern "C" {
    pub fn CreateIpoptProblem(
        n: Index,
        x_L: *mut Number,
        x_U: *mut Number,
        m: Index,
        g_L: *mut Number,
        g_U: *mut Number,
        nele_jac: Index,
        nele_hess: Index,
        index_style: Index,
        eval_f: Eval_F_CB,
        eval_g: Eval_G_CB,
        eval_grad_f: Eval_Grad_F_CB,
        eval_jac_g: Eval_Jac_G_CB,
        eval_h: Eval_H_CB,
    ) -> IpoptProblem;
    pub fn FreeIpoptProblem(ipopt_problem: IpoptProblem);
    pub fn AddIpoptStrOption(
        ipopt_problem: IpoptProblem,
        keyword: *mut std::ffi::c_char,
        val: *mut std::ffi::c_char,
    ) -> Bool;
    pub fn AddIpoptNumOption(
        ipopt_problem: IpoptProblem,
        keyword: *mut std::ffi::c_char,
        val: Number,
    ) -> Bool;
    pub fn AddIpoptIntOption(
        ipopt_problem: IpoptProblem,
        keyword: *mut std::ffi::c_char,
        val: Int,
    ) -> Bool;
    pub fn SetIntermediateCallback(
        ipopt_problem: IpoptProblem,
        intermediate_cb: Intermediate_CB,
    ) -> Bool;
    pub fn IpoptSolve(
        ipopt_problem: IpoptProblem,
        x: *mut Number,
        g: *mut Number,
        obj_val: *mut Number,
        mult_g: *mut Number,
        mult_x_L: *mut Number,
        mult_x_U: *mut Number,
        user_data: UserDataPtr,
    ) -> ApplicationReturnStatus;
}
