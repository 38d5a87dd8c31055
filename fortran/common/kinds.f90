!> The working precision of the kernels. Facades say c_double by name, because f2py maps
!> any other name of the kind silently to a C float; the two are the same kind.
module common_kinds
   use, intrinsic :: iso_c_binding, only : c_double, c_int
   implicit none
   private
   public :: wp, pi, gravity

   integer, parameter :: wp = c_double
   real(wp), parameter :: pi = 3.14159265358979323846264338327950288_wp
   !> Standard gravity [m/s^2]
   real(wp), parameter :: gravity = 9.80665_wp

end module common_kinds
