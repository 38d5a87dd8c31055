!> Coaxial total-strain law of a point of plane stress, with cracks that close (Rots 1988; Cope and others 1980).
!>
!> Principal stresses follow principal strains. The compliance there is that of the events (thesis Eqs 4.9, 4.10),
!>
!>    e_i = s_i / E_i - nu s_j / E,   E_i = E w_t(k_t) where s_i > 0, E w_c(k_c) where s_i < 0,
!>
!> so that q_i = s_i / E_i is the strain of the uniaxial law. The histories k_t = max q_i and k_c = max -q_i are one
!> number each for both directions. The secants w follow the softening law itself, without teeth.
!>
!> With k frozen, the complementary energy s_1^2 / (2 E_1) + s_2^2 / (2 E_2) - nu s_1 s_2 / E is a convex and symmetric
!> function of the principal stresses for nu < 1, as E_i <= E. The energy of the strain, its conjugate, is therefore
!> convex as well: the state of a structure with frozen damage is unique, and Newton's method with a line search on the
!> energy finds it. For nu = 0 the sign of the strain decides.
module sla_coaxial
   use common_kinds, only : wp
   use sla_sawtooth, only : softening
   implicit none
   private
   public :: coaxial_law, coaxial_state, coaxial_response
   public :: by_tangent, by_secant, by_frozen

   !> How the response follows from the histories: they grow with the strain, and the matrix is the tangent or the
   !> secant; or they stay, and the matrix is the derivative of the stress
   integer, parameter :: by_tangent = 1, by_secant = 2, by_frozen = 3

   !> The material of a point
   type :: coaxial_law
      real(wp) :: young = 0.0_wp           !! [Pa]
      real(wp) :: nu = 0.0_wp
      real(wp) :: floor = 0.0_wp           !! stiffness left over the initial one
      logical :: cracks = .false.
      logical :: crushes = .false.
      type(softening) :: tension
      type(softening) :: compression
   contains
      procedure :: moduli
      procedure :: lost_energy
   end type coaxial_law

   !> Response of a point
   type :: coaxial_state
      real(wp) :: sigma(3) = 0.0_wp        !! sx, sy, txy [Pa]
      real(wp) :: matrix(3, 3) = 0.0_wp    !! [Pa]
      real(wp) :: energy = 0.0_wp          !! stored at the present damage [J/m^3]
      real(wp) :: history(2) = 0.0_wp      !! k_t and k_c with this strain
      real(wp) :: shared = 0.0_wp          !! (lesser / greater q)^2 of two directions in tension
      real(wp) :: normal(2) = [1.0_wp, 0.0_wp]   !! direction of the greater principal strain
      real(wp) :: principal(2) = 0.0_wp    !! stresses [Pa]
      real(wp) :: stiff(4) = 0.0_wp        !! secant Dnn, Dns, Dss, G in the principal axes [Pa]
   end type coaxial_state

   integer, parameter :: most_iterations = 100
   real(wp), parameter :: tolerance = 1.0e-12_wp
   !> Least determinant of a tangent compliance over that of the secant one
   real(wp), parameter :: least_determinant = 0.05_wp

contains

   !> Secant moduli in tension and compression at histories [Pa]
   pure function moduli(law, history) result(modulus)
      class(coaxial_law), intent(in) :: law
      real(wp), intent(in) :: history(2)
      real(wp) :: modulus(2)
      modulus = law%young
      if (law%cracks) modulus(1) = max(law%tension%secant(history(1)), law%floor * law%young)
      if (law%crushes) modulus(2) = max(law%compression%secant(history(2)), law%floor * law%young)
   end function moduli

   !> Energy that histories have cost in one direction [J/m^3]
   pure function lost_energy(law, history) result(lost)
      class(coaxial_law), intent(in) :: law
      real(wp), intent(in) :: history(2)
      real(wp) :: lost(2)
      lost = 0.0_wp
      if (law%cracks) lost(1) = law%tension%lost(history(1))
      if (law%crushes) lost(2) = law%compression%lost(history(2))
   end function lost_energy

   !> Stress, matrix and histories of a strain
   pure subroutine coaxial_response(law, eps, history, how, state)
      type(coaxial_law), intent(in) :: law
      real(wp), intent(in) :: eps(3)          !! ex, ey, gxy
      real(wp), intent(in) :: history(2)
      integer, intent(in) :: how              !! by_...
      type(coaxial_state), intent(out) :: state
      real(wp) :: mean, half(2), radius, e(2), modulus(2), e_of(2), slope(2), q(2), k(2), next(2), g, c, s
      real(wp) :: t(3, 3)
      integer :: i

      mean = 0.5_wp * (eps(1) + eps(2))
      half = 0.5_wp * [eps(1) - eps(2), eps(3)]
      radius = norm2(half)
      e = [mean + radius, mean - radius]
      k = history
      do i = 1, most_iterations
         modulus = law%moduli(k)
         call principal_stresses(e, modulus, law%nu / law%young, state%principal, e_of)
         q = state%principal / e_of
         state%history = history
         if (law%cracks) state%history(1) = max(history(1), maxval(q))
         if (law%crushes) state%history(2) = max(history(2), -minval(q))
         if (how == by_frozen) exit
         next = state%history
         if (maxval(abs(next - k)) <= tolerance * maxval(next)) exit
         if (2 * i > most_iterations) next = 0.5_wp * (next + k)
         k = next
      end do
      state%energy = 0.5_wp * dot_product(state%principal, e)
      if (minval(q) > 0.0_wp) state%shared = (minval(q) / maxval(q))**2

      slope = e_of
      if (how == by_tangent) then
         if (law%cracks .and. k(1) > max(history(1), law%tension%peak)) then
            i = merge(1, 2, q(1) >= q(2))
            if (modulus(1) > law%floor * law%young) slope(i) = law%tension%slope(k(1))
         end if
         if (law%crushes .and. k(2) > max(history(2), law%compression%peak)) then
            i = merge(1, 2, q(1) <= q(2))
            if (modulus(2) > law%floor * law%young) slope(i) = law%compression%slope(k(2))
         end if
      end if
      if (e(1) - e(2) > 1.0e-9_wp * maxval(abs(e))) then
         g = 0.5_wp * (state%principal(1) - state%principal(2)) / (e(1) - e(2))
      else
         g = 0.5_wp * minval(e_of) / (1.0_wp + law%nu * minval(e_of) / law%young)
      end if
      state%stiff = [plane_stiffness(e_of, law%nu / law%young), g]

      ! The rows of t are the strains of unit stresses along and across the principal directions
      c = 1.0_wp
      s = 0.0_wp
      if (radius > 0.0_wp) then
         c = half(1) / radius
         s = half(2) / radius
      end if
      t(:, 1) = [0.5_wp * (1.0_wp + c), 0.5_wp * (1.0_wp - c), 0.5_wp * s]
      t(:, 2) = [0.5_wp * (1.0_wp - c), 0.5_wp * (1.0_wp + c), -0.5_wp * s]
      t(:, 3) = [-s, s, c]
      state%normal = [sqrt(0.5_wp * (1.0_wp + c)), sign(sqrt(0.5_wp * (1.0_wp - c)), s)]
      state%sigma = state%principal(1) * t(:, 1) + state%principal(2) * t(:, 2)
      associate (d => plane_stiffness(slope, law%nu / law%young))
         do i = 1, 3
            state%matrix(:, i) = d(1) * t(:, 1) * t(i, 1) + d(2) * (t(:, 1) * t(i, 2) + t(:, 2) * t(i, 1)) + &
               d(3) * t(:, 2) * t(i, 2) + g * t(:, 3) * t(i, 3)
         end do
      end associate
   end subroutine coaxial_response

   !> Principal stresses of principal strains e(1) >= e(2): the one solution whose signs are those of its moduli
   pure subroutine principal_stresses(e, modulus, share, stress, of)
      real(wp), intent(in) :: e(2)
      real(wp), intent(in) :: modulus(2)     !! in tension and in compression [Pa]
      real(wp), intent(in) :: share          !! nu / E [1/Pa]
      real(wp), intent(out) :: stress(2)     !! [Pa]
      real(wp), intent(out) :: of(2)         !! the modulus of each [Pa]
      integer :: way
      do way = 1, 3
         of = modulus(merge([1, 2], merge([1, 1], [2, 2], way == 2), way == 1))
         associate (d => plane_stiffness(of, share))
            stress = [d(1) * e(1) + d(2) * e(2), d(2) * e(1) + d(3) * e(2)]
         end associate
         if (way == 1 .and. stress(1) >= 0.0_wp .and. stress(2) <= 0.0_wp) return
         if (way == 2 .and. stress(2) >= 0.0_wp) return
      end do
   end subroutine principal_stresses

   !> Dnn, Dns, Dss of two moduli [Pa]
   pure function plane_stiffness(modulus, share) result(d)
      real(wp), intent(in) :: modulus(2)     !! [Pa]
      real(wp), intent(in) :: share          !! nu / E [1/Pa]
      real(wp) :: d(3), determinant
      determinant = max(1.0_wp - share**2 * modulus(1) * modulus(2), least_determinant)
      d = [modulus(1), share * modulus(1) * modulus(2), modulus(2)] / determinant
   end function plane_stiffness

end module sla_coaxial
