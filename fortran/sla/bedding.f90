!> Masonry laid in courses (bedded): weaker across its bed joints than along them.
!>
!> Its uncracked points follow Rankine's criterion with two strengths (Lourenco, de Borst and Rots 1997): in the axes of
!> the joints, x along the beds, (fx - sx)(fy - sy) >= a t^2 with a = fx fy / shear strength^2. That is the isotropic
!> one of the image (sx - fx + f, sy - fy + f, sqrt(a) t) with the strength f, so lambda has the same closed form; the
!> crack's normal is the principal direction of the image, which is turned towards that of the weaker joints.
!>
!> Crushed it is by Hill's criterion in the same axes (Lourenco, de Borst and Rots 1997), with the strengths fx along
!> and fy across the beds: (sx/fx)^2 + b sx sy / (fx fy) + (sy/fy)^2 + c t^2 / (fx fy) <= 1, a quadratic in lambda.
module sla_bedding
   use common_kinds, only : wp
   implicit none
   private
   public :: bedding, in_joint_axes, between, hill, hill_strength

   !> Strengths along the bed joints over those across them, see the head of this module
   type :: bedding
      real(wp) :: angle = 0.0_wp       !! of the bed joints to x [rad]
      real(wp) :: strength = 0.0_wp    !! tensile strength, 0: masonry without joints, isotropic
      real(wp) :: energy = 0.0_wp      !! fracture energy
      real(wp) :: shear = 1.0_wp       !! sqrt(a), at least 1
      real(wp) :: width = 0.0_wp       !! crack band, 0 the element's across the crack [m]
      real(wp) :: crush = 0.0_wp       !! compressive strength along the beds over that across them, 0: one for all
      real(wp) :: coupling = 0.0_wp    !! b of Hill's criterion
      real(wp) :: crush_shear = 0.0_wp !! c of it
   end type bedding

contains

   !> The stress in the axes of the joints whose isotropic criterion with the strength f is that of bedded masonry; of
   !> the change of a stress where f is 0
   pure function in_joint_axes(bed, s, f) result(image)
      type(bedding), intent(in) :: bed
      real(wp), intent(in) :: s(3)     !! sx, sy, txy [Pa]
      real(wp), intent(in) :: f        !! strength across the bed joints [Pa]
      real(wp) :: image(3)
      image = turned(bed, s)
      image = [image(1) + f * (1.0_wp - bed%strength), image(2), bed%shear * image(3)]
   end function in_joint_axes

   !> Hill's form of two stresses, in units of the strength across the beds: at most its square where both are one
   pure function hill(bed, a, b) result(form)
      type(bedding), intent(in) :: bed
      real(wp), intent(in) :: a(3), b(3)     !! sx, sy, txy [Pa]
      real(wp) :: form, u(3), v(3)           !! [Pa^2]
      u = turned(bed, a)
      v = turned(bed, b)
      form = u(1) * v(1) / bed%crush**2 + u(2) * v(2) + (0.5_wp * bed%coupling * (u(1) * v(2) + u(2) * v(1)) + &
         bed%crush_shear * u(3) * v(3)) / bed%crush
   end function hill

   !> Strength under pressure in one direction alone, over that across the beds
   pure function hill_strength(bed, n) result(ratio)
      type(bedding), intent(in) :: bed
      real(wp), intent(in) :: n(2)           !! direction of the pressure
      real(wp) :: ratio, stress(3)
      stress = [n(1)**2, n(2)**2, n(1) * n(2)]
      ratio = 1.0_wp / sqrt(hill(bed, stress, stress))
   end function hill_strength

   !> A stress in the axes of the joints
   pure function turned(bed, s) result(t)
      type(bedding), intent(in) :: bed
      real(wp), intent(in) :: s(3)           !! sx, sy, txy [Pa]
      real(wp) :: t(3), m, c, s2, d
      m = 0.5_wp * (s(1) + s(2))
      c = cos(2.0_wp * bed%angle)
      s2 = sin(2.0_wp * bed%angle)
      d = 0.5_wp * (s(1) - s(2)) * c + s(3) * s2
      t = [m + d, m - d, s(3) * c - 0.5_wp * (s(1) - s(2)) * s2]
   end function turned

   !> A property across a crack, over that across the bed joints: f(n) = nx^2 fx + ny^2 fy
   pure function between(bed, n, along) result(ratio)
      type(bedding), intent(in) :: bed
      real(wp), intent(in) :: n(2)     !! normal of the crack
      real(wp), intent(in) :: along    !! the property along the bed joints
      real(wp) :: ratio
      ratio = 1.0_wp + (along - 1.0_wp) * (n(1) * cos(bed%angle) + n(2) * sin(bed%angle))**2
   end function between

end module sla_bedding
